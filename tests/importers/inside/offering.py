"""Looks for calls that an importer has or has not."""

import re


def offers(words: str, *classes: type) -> bool:
    """Whether a public name of these classes has one of the words, a regular expression."""
    names = (name for each in classes for name in dir(each) if not name.startswith("_"))
    return any(re.search(words, name) for name in names)

"""Makes markup and script shorter without changing what they do."""

import re
from collections import Counter
from collections.abc import Mapping
from itertools import product
from typing import Final

_DECLARED: Final = re.compile(r"\b(?:let|function\*?|class) ?([A-Za-z_$][\w$]*)")
_WORD: Final = re.compile(r"(?<![\w$])[A-Za-z_$][\w$]{3,}")
# Two humps, as no word of a text or name of a property that is looked up has them by chance.
_HUMPED: Final = re.compile(r"[a-z][A-Z]|[A-Z]_?[A-Z]")
_METHOD: Final = re.compile(r"\([^()]*\)\{")
# A statement ends at a brace or a semicolon: no expression of the page goes on after the break.
_LINE: Final = re.compile(r"(?<=\})\n(?=[A-Za-z])")
_GLOBALS: Final = {"Math": "M", "Number": "$N", "Infinity": "$I", "document": "$D", "Object": "$O"}
_GLOBAL: Final = re.compile(
    r"(?<![\w$.\"])(?:(?:Math|document|Object)(?=\.)|Number(?=[.()])|Infinity(?![\w$:\"]))"
)
_ZERO: Final = re.compile(r"(?<=[=(,:*+\-/<>?\[])0(?=\.\d)")
# What stands in a template and holds neither text nor braces, and its operators.
_INSERT: Final = re.compile(r"(?<=\$\{)[^{}\"'`]+(?=\})")
_OPERATOR: Final = re.compile(r" ?([-+*/<>?:,&|=]+) ?")
# JavaScript lets a list end in a comma.
_COMMA: Final = re.compile(r",(?=[}\])])")
_STRING: Final = re.compile(r'"[^"\n]*"')
_ATTRIBUTE: Final = re.compile(r'(?<=\s)([\w-]+)="([\w#.:%-]+)"(?=[\s>])')
# A break before a block, or a part of a list or table, shows nothing.
_BREAK: Final = re.compile(
    r"\n(?=</?(?:p|div|section|t[dhr]|tbody|thead|table|[uod]l|li|d[dt]|h\d|article|figure|details"
    r"|summary|svg|main|footer|header|nav)\b)"
)
_DIGITS: Final = "0123456789abcdefghijklmnopqrstuvwxyz"
# End tags that HTML lets one leave out wherever the next element or the parent's end follows.
_OPTIONAL_ENDS: Final = re.compile(
    r"</(?:t[dhr]|d[dt]|li|tbody|thead|option)>(?=\s*<)"
    r"|</p>(?=\s*(?:<(?:p|[uo]l|table|section|details|div|h\d|article|figure)\b"
    r"|</(?:section|div|article|details|li|td)>))"
)


def script(text: str, names: Mapping[str, str] | None = None) -> str:
    """Return a script, or a piece of one, without comments and blanks and in shorter words.

    No loop of the page has an empty body, which the semicolon before a closing brace would be.

    Parameters
    ----------
    text
        JavaScript.
    names
        What is to be called otherwise, as `short_names` gives it for the whole script.
    """
    from rjsmin import jsmin

    text = re.sub(r"\bconst\b(?=[ \[{])", "let", jsmin(text)).replace(";}", "}")
    text = _ZERO.sub("", _COMMA.sub("", text))
    text = _INSERT.sub(lambda found: _OPERATOR.sub(r"\1", found[0]), text)
    text = _GLOBAL.sub(lambda found: _GLOBALS[found[0]], _LINE.sub("", text))
    return _WORD.sub(lambda found: (names or {}).get(found[0], found[0]), text)


def short_names(text: str) -> dict[str, str]:
    """Return shorter names for what a whole script declares, where a name is nothing else in it.

    A name is left as it is if it is anywhere a property, a key or part of a string, or without two
    humps (`numbersOf`, `MOST_ARCS`), as it might be a word of a text.
    """
    text = script(text)
    strings = set(_WORD.findall(" ".join(_STRING.findall(text))))
    found = [match for match in _WORD.finditer(text) if _HUMPED.search(match[0])]
    used = {match[0] for match in found if _is_otherwise_used(text, *match.span())} | strings
    count = Counter(match[0] for match in found)
    names = {name for name in _DECLARED.findall(text) if name in count} - used
    short = (f"${''.join(each)}" for length in (1, 2) for each in product(_DIGITS, repeat=length))
    # The names with most to gain get the shortest; alike ones by the alphabet, for ever the same.
    return dict(zip(sorted(names, key=lambda name: (-count[name], name)), short, strict=False))


def _is_otherwise_used(text: str, start: int, end: int) -> bool:
    """Tell whether a name in a script may be a property, a key or a method."""
    before, after = text[start - 1], text[end : end + 1]
    is_property = before == "." and text[start - 3 : start] != "..."
    is_key = after == ":" or (before in "{," and after in ",}=")
    is_accessor = text[start - 4 : start] in ("get ", "set ")
    is_method = before in "{,*" and _METHOD.match(text, end) is not None
    return is_property or is_key or is_accessor or is_method


def markup(text: str) -> str:
    """Return markup without needless blanks and end tags."""
    lines = "\n".join(filter(None, map(str.strip, text.splitlines())))
    return _BREAK.sub("", _OPTIONAL_ENDS.sub("", lines))


def bare(tags: str) -> str:
    """Return markup that holds no script with its simple attributes out of quotes."""
    return _ATTRIBUTE.sub(r"\1=\2", tags)


def globals_of_script() -> str:
    """Return the statement that gives the globals of a script their short names."""
    return f"let {','.join(f'{short}={name}' for name, short in _GLOBALS.items())};"

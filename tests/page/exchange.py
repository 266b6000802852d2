"""Numbers to the page and back as text, which keeps doubles to the last bit and takes no time."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from playwright.sync_api import Page

_NAMES = {"NaN": float("nan"), "Infinity": float("inf"), "-Infinity": float("-inf")}


def ask(page: Page, function: str, question: Any) -> Any:
    """Call a function of JavaScript in the page.

    Parameters
    ----------
    page
        The open page.
    function
        Source of a function of one argument.
    question
        Its argument: finite numbers, texts, lists and dictionaries.

    Returns
    -------
    Any
        What the function returns, infinities and no-numbers included.
    """
    # JSON has no words for what is not finite, so that travels by its name.
    text = page.evaluate(
        f"""question => JSON.stringify(
          ({function})(JSON.parse(question)),
          (_, value) => typeof value === "number" && !Number.isFinite(value) ? `${{value}}` : value,
        )""",
        json.dumps(question, allow_nan=False),
    )
    return _with_numbers(json.loads(text))


def _with_numbers(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _with_numbers(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_with_numbers(each) for each in value]
    return _NAMES.get(value, value) if isinstance(value, str) else value

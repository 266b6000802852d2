"""SVG made fit for one page: thinned lines, short numbers, ids of its own."""

from __future__ import annotations

import html
import re

import numpy as np

from stickslip_verification.record import Series

SHAPE = 0.1
"""Distance [pt] by which a thinned line may leave the full one; a tenth of a line's width."""

# A factor is no length: what it shrinks would show how it was rounded.
_NUMBER = re.compile(r"(?:scale|matrix)\([^)]*\)|-?\d+\.\d+(?:e[-+]?\d+)?")
_TAG = re.compile(r"<[^>]*>")
_MARK = re.compile(r'<path id="([^"]+)" d="([^"]+)"(?: style="([^"]*)")?/>')
_USE = re.compile(r'<use href="#([^"]+)" x="([^"]+)" y="([^"]+)"(?: style="([^"]*)")?/>')
_USES = re.compile(r"<g([^>]*)>((?:\s*<use [^>]*/>)+)\s*</g>")


def thinned(x: Series, y: Series) -> tuple[Series, Series]:
    """Leave out the points of a line that change its shape by less than `SHAPE`.

    Ramer, Comput. Graph. Image Process. 1 (1972) 244, and Douglas and Peucker, Cartographica 10
    (1973) 112: corners stay, and what is straight becomes two points. A gap (NaN) splits the line.

    Parameters
    ----------
    x, y
        The line [pt], shape ``(n,)`` each.
    """
    finite = np.isfinite(x) & np.isfinite(y)
    keep = np.zeros(len(x), dtype=bool)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], finite.astype(int), [0]))))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        _mark(x, y, keep, int(begin), int(end) - 1)
        if end < len(x):
            keep[end] = True
    return x[keep], y[keep]


def _mark(x: Series, y: Series, keep: np.ndarray[tuple[int], np.dtype[np.bool_]], first: int,
          last: int) -> None:  # fmt: skip
    keep[[first, last]] = True
    waiting = [(first, last)]
    while waiting:
        a, b = waiting.pop()
        if b - a < 2:
            continue
        dx, dy = x[b] - x[a], y[b] - y[a]
        length = float(np.hypot(dx, dy))
        inner_x, inner_y = x[a + 1 : b] - x[a], y[a + 1 : b] - y[a]
        if length > 0.0:
            away = np.abs(inner_x * dy - inner_y * dx) / length
        else:
            away = np.hypot(inner_x, inner_y)
        furthest = int(np.argmax(away))
        if away[furthest] > SHAPE:
            middle = a + 1 + furthest
            keep[middle] = True
            waiting += [(a, middle), (middle, b)]


def columns(x: Series, y: Series) -> tuple[Series, Series]:
    """Keep the lowest and the highest point of each column one point [pt] wide, in their order.

    What is left covers what the full line covers; gaps (NaN) are dropped with their points.
    """
    told = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    if not len(told):
        return x[:0], y[:0]
    starts = np.flatnonzero(np.diff(np.floor(x[told]), prepend=-np.inf))
    keep: set[int] = {int(told[0]), int(told[-1])}
    for part in np.split(told, starts[1:]):
        keep |= {int(part[np.argmin(y[part])]), int(part[np.argmax(y[part])])}
    chosen = np.array(sorted(keep))
    return x[chosen], y[chosen]


def tidy(svg: str, prefix: str, title: str) -> str:
    """Make an SVG file a part of a page.

    Prologue, comments, metadata and fonts go, numbers keep two decimals, an id that nothing refers
    to goes and every other one is `prefix` and a number; `title` is what a screen reader says.
    """
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<!--.*?-->|<metadata>.*?</metadata>|<style.*?</style>", "", svg, flags=re.DOTALL)
    # Only inside tags: the number at a tick is text and stays.
    svg = _TAG.sub(lambda tag: _NUMBER.sub(_short, tag[0]), svg)
    svg = re.sub(r' transform="rotate\(-?0 [^"]*"|font-family: [^;"]*;? ?', "", svg)
    svg = re.sub(r"(font: [\d.]+px) [^;\"]*", r"\1 sans-serif", svg)
    svg = _with_own_ids(_without_uses(svg.replace("xlink:href", "href")), prefix)
    svg = re.sub(r"<defs>\s*</defs>", "", svg)
    svg = re.sub(r"\s*\n\s*", "\n", svg)
    svg = re.sub(r"(?<=[\d.])\n?([ML]) |\n(?=\" )", r"\1", svg)
    svg = _without_plain_groups(svg)
    head, body = svg[: svg.index(">")], svg[svg.index(">") + 1 :]
    head = re.sub(r'\s(?!viewBox)[\w:-]+="[^"]*"', "", head)
    head += f' role="img" aria-label="{html.escape(title)}" font-family="sans-serif"'
    return f'{head} stroke-linejoin="round" stroke-linecap="butt">{body}'.strip()


def _without_plain_groups(svg: str) -> str:
    kept: list[str] = []
    plain: list[bool] = []
    for part in re.split(r"(<g\b[^>]*>|</g>)", svg):
        if part == "</g>":
            if not plain.pop():
                kept.append(part)
        elif part.startswith("<g"):
            plain.append(part == "<g>")
            if not plain[-1]:
                kept.append(part)
        else:
            kept.append(part.lstrip("\n"))
    return "".join(kept)


def _with_own_ids(svg: str, prefix: str) -> str:
    names: dict[str, str] = {}
    for name in re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', svg):
        names.setdefault("".join(name), f"{prefix}-{len(names)}")
    svg = re.sub(r'(?<=href="#)[^"]+|(?<=url\(#)[^)]+', lambda found: names[found[0]], svg)
    return re.sub(
        r' id="([^"]*)"',
        lambda found: f' id="{names[found[1]]}"' if found[1] in names else "",
        svg,
    )


def _without_uses(svg: str) -> str:
    """Draw the markers of a group, which matplotlib refers to one by one, as a single path."""
    marks = {found[1]: (found[2], found[3]) for found in _MARK.finditer(svg)}

    def drawn(found: re.Match[str]) -> str:
        uses = _USE.findall(found[2])
        kinds = {(name, style) for name, _, _, style in uses}
        if len(kinds) != 1 or next(iter(kinds))[0] not in marks:
            return found[0]
        name, style = kinds.pop()
        shape, own = marks[name]
        path = "".join(f"M{x} {y}{_relative(shape)}" for _, x, y, _ in uses)
        return f'<g{found[1]}><path d="{path}" style="{style}; {own}"/></g>'

    svg = _USES.sub(drawn, svg)
    # What a group still refers to stays.
    return _MARK.sub(lambda found: found[0] if f'"#{found[1]}"' in svg else "", svg)


def _relative(shape: str) -> str:
    """Write a marker, given around the origin, as steps from where it is put."""
    steps = re.findall(r"([MLCz])([^MLCz]*)", shape)
    if sum(letter == "C" for letter, _ in steps) == 8:
        # Only its circle has eight cubics, and it begins below its centre.
        r = f"{float(steps[0][1].split()[1]):.4g}"
        return f"m0 {r}a{r} {r} 0 1 0 0-{2 * float(r):.4g}a{r} {r} 0 1 0 0 {2 * float(r):.4g}z"
    text, x, y = "", 0.0, 0.0
    for letter, numbers in steps:
        if letter == "z":
            text += "z"
            continue
        to_x, to_y = (float(number) for number in numbers.split())
        text += f"{letter.lower()}{to_x - x:.4g} {to_y - y:.4g}"
        x, y = to_x, to_y
    return text


def _short(found: re.Match[str]) -> str:
    if found[0].endswith(")"):
        return found[0]
    text = f"{float(found[0]):.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text

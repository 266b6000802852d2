"""SVG text made small: short numbers, ids of its own, markers as one path."""

from __future__ import annotations

import html
import itertools
import re
from collections import Counter

# A factor is no length: what it shrinks would show how it was rounded.
_NUMBER = re.compile(r"(?:scale|matrix)\([^)]*\)|-?\d+\.\d+(?:e[-+]?\d+)?")
_NOTHING = r"<!--.*?-->|<metadata>.*?</metadata>|<style.*?</style>|<g [^>]*/>"
_TAG = re.compile(r"<[^>]*>")
_DEFS = re.compile(r"<defs>(.*?)</defs>", re.DOTALL)
_MARK = re.compile(r'<path id="([^"]+)" d="([^"]+)"(?: style="([^"]*)")?/>')
_USE = re.compile(r'<use href="#([^"]+)" x="([^"]+)" y="([^"]+)"(?: style="([^"]*)")?/>')
_USES = re.compile(rf"(?:{_USE.pattern}\s*)+")
_LETTER = re.compile(r'(?<= d=")([^"]*)" transform="scale\(0\.015625\)"')
_DOT = re.compile(r"m0 ([\d.]+)a[^z]*z")
_LABEL = re.compile(r"(<g [^>]*>)\s*((?:<use [^>]*/>\s*){2,})</g>")
_LOOK = 'font-family="sans-serif" stroke-linejoin="round" stroke-linecap="butt"'


def tidy(svg: str, prefix: str, title: str) -> str:
    """Make an SVG file a part of a page.

    Prologue, comments, metadata and fonts go, numbers keep two decimals, an id that nothing refers
    to goes and every other one is `prefix` and a number; `title` is what a screen reader says.
    """
    head, body = _small(svg, prefix)
    kept = "".join(re.findall(r'\sviewBox="[^"]*"', head))
    return f'<svg{kept} role="img" aria-label="{html.escape(title)}" {_LOOK}>{body}'


def standalone(svg: str, title: str) -> str:
    """Make an SVG file as small as `tidy` does, but leave it a file, with a size and a title."""
    head, body = _small(svg, "p")
    kept = "".join(re.findall(r'\s(?:width|height|viewBox|xmlns)="[^"]*"', head))
    return f"<svg{kept} {_LOOK}>\n<title>{html.escape(title)}</title>\n{body}\n"


def _small(svg: str, prefix: str) -> tuple[str, str]:
    """Split a picture into its root's tag and a small text of all that is in the root."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(_NOTHING, "", svg, flags=re.DOTALL)
    # Only inside tags: the number at a tick is text and stays.
    svg = _TAG.sub(lambda tag: _NUMBER.sub(_short, tag[0]), svg)
    svg = re.sub(r' transform="rotate\(-?0 [^"]*"|font-family: [^;"]*;? ?', "", svg)
    svg = re.sub(r"(font: [\d.]+px) [^;\"]*", r"\1 sans-serif", svg)
    svg = _with_own_ids(svg.replace("xlink:href", "href"), prefix)
    head, _, body = svg.partition(">")
    defined = "".join(_DEFS.findall(body))
    drawn = _without_plain_groups(re.sub(r"\s*\n\s*", "\n", _DEFS.sub("", body)))
    defined, drawn = _without_uses(defined, drawn)
    defined, drawn = _with_small_labels(defined, drawn, prefix)
    body = re.sub(r"\s*\n\s*", "\n", f"<defs>\n{defined}\n</defs>\n{drawn}")
    body = re.sub(r"(?<=[\d.z])\n?([MLQz]) ?|\n(?=\" )", r"\1", body)
    return head, body.strip()


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
        r' id="([^"]*)"', lambda found: f' id="{names[found[1]]}"' if found[1] in names else "", svg
    )


def _without_uses(defined: str, drawn: str) -> tuple[str, str]:
    """Draw neighbouring markers, which matplotlib refers to one by one, as a single path."""
    marks = {found[1]: (found[2], found[3] or "") for found in _MARK.finditer(defined)}

    def joined(found: re.Match[str]) -> str:
        paths = ""
        uses = _USE.findall(found[0])
        for (name, style), places in itertools.groupby(uses, lambda use: (use[0], use[3])):
            if name not in marks:
                return found[0]
            shape, own = marks[name]
            # What a mark says of itself comes last: it overrules what its use says.
            look = dict(re.findall(r"([\w-]+): ([^;]+)", f"{style}; {own}"))
            step = _relative(shape)
            if (dot := _DOT.fullmatch(step)) and "stroke" not in look:
                # A line without length shows its round ends.
                look = {"stroke": look["fill"], "stroke-width": f"{2.0 * float(dot[1]):g}"}
                look["stroke-linecap"], step = "round", "h0"
            path = "".join(f"M{x} {y}{step}" for _, x, y, _ in places)
            told = "; ".join(f"{key}: {value}" for key, value in look.items())
            paths += f'<path d="{path}" style="{told}"/>\n'
        return paths

    drawn = _USES.sub(joined, drawn)
    # What is still referred to stays.
    defined = _MARK.sub(lambda found: found[0] if f'"#{found[1]}"' in drawn else "", defined)
    return defined, drawn


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
    return text.removeprefix("m0 0")


def _with_small_labels(defined: str, drawn: str, prefix: str) -> tuple[str, str]:
    """Round the outlines of letters to 1/400 of their size, and define a repeated label once."""

    def rounded(found: re.Match[str]) -> str:
        outline = re.sub(r"-?\d+", lambda number: f"{round(int(number[0]) / 16)}", found[1])
        return f'{outline}" transform="scale(0.25)"'

    drawn = re.sub(r'transform="translate\(([\d.]+) 0\)"/>', r'x="\1"/>', drawn)
    groups = Counter(found[2] for found in _LABEL.finditer(drawn))
    repeated = [label for label, times in groups.items() if times > 1]
    names = {label: f"{prefix}-label-{number}" for number, label in enumerate(repeated)}

    def named(found: re.Match[str]) -> str:
        name = names.get(found[2])
        return f'{found[1]}<use href="#{name}"/></g>' if name else found[0]

    labels = "".join(f'<g id="{name}">{label}</g>' for label, name in names.items())
    return _LETTER.sub(rounded, defined) + labels, _LABEL.sub(named, drawn)


def _short(found: re.Match[str]) -> str:
    if found[0].endswith(")"):
        return found[0]
    text = f"{float(found[0]):.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text

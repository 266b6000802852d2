"""The page of the claims, in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from stickslip_design.claims.finding import Finding

PLOTS = "claims"
"""Folder of the plots, beside the page."""


def markdown(findings: Iterable[Finding]) -> Iterator[str]:
    """Give the lines of the page: every claim with its verdict, its numbers and its plot."""
    found = tuple(findings)
    yield "# What designers are told, in numbers"
    yield ""
    yield "Rules of thumb for stick-slip, each tried against the exact solution of the block (a"
    yield "mass on a dry way, pulled through a spring at the speed v) in high precision. The"
    yield "formulas are derived in docs/theory.md; the data files in"
    yield "`verification/stickslip_verification/claims` say where each claim is tried. Figures are"
    yield "rounded, deviations are relative to the exact value."
    yield ""
    yield "Without damping one number decides how well the rules hold:"
    yield ""
    yield "    λ = w Δ / v      w = sqrt(k / m)      Δ = (mu_s - mu_k) m g / k"
    yield ""
    yield "It compares the speed that the gap between the two frictions can give the mass with the"
    yield "speed of the pull: large λ is slow pull, small λ fast pull. Put your own m in kg, k in"
    yield "N/m, g in m/s² and v in m/s; `stickslip simulate` prints the exact cycle beside the"
    yield "formulas. With damping the damping ratio ζ = c / (2 m w) counts as well."
    yield ""
    yield "| claim | verdict |"
    yield "|---|---|"
    for each in found:
        yield f"| {each.title}: `{each.formula}` | {each.verdict} |"
    for each in found:
        yield ""
        yield from _section(each)


def _section(finding: Finding) -> Iterator[str]:
    yield f"## {finding.title}"
    yield ""
    yield f"> {finding.claim} `{finding.formula}`"
    yield ">"
    yield f"> ({finding.source})"
    yield ""
    yield f"**{_capital(finding.verdict)}.** {finding.sentence}"
    yield ""
    yield "| " + " | ".join(finding.header) + " |"
    yield "|" + "---|" * len(finding.header)
    for row in finding.rows:
        yield "| " + " | ".join(row) + " |"
    yield ""
    yield f"Tried with {finding.block}."
    yield ""
    yield f"![{finding.title}: {finding.verdict}]({PLOTS}/{finding.id}.svg)"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]

"""The page of the claims, in Markdown."""

from collections.abc import Iterable, Iterator

from stickslip_design.claims.finding import Finding

PLOTS = "claims"
"""Folder of the plots, beside the page."""


def markdown(findings: Iterable[Finding]) -> Iterator[str]:
    """Yield the lines of the page: every claim with its verdict, its numbers and its plot."""
    found = tuple(findings)
    yield from """\
# Rules of thumb for stick-slip, in numbers

For designers who use rules of thumb for stick-slip. For each rule this page says where it
holds to 10 %, and how wrong it is elsewhere.

The rules are compared with the exact solution of the block in high precision. The block is a
mass on a dry way that a spring pulls at the speed v.

- Deviations are relative to the exact value. Figures are rounded.
- The formulas are derived in [theory.md](theory.md). Numbers in brackets are its equations.
- The data files in `workbench/stickslip_design/claims` list the settings of each
  comparison.

To use a rule, compute λ from your own m in kg, k in N/m, g in m/s² and v in m/s:

    λ = w Δ / v      w = sqrt(k / m)      Δ = (mu_s - mu_k) m g / k

Without damping, λ alone decides how well the rules for jump and slip time hold. λ is the ratio
of two speeds: the speed that the gap between static and kinetic friction can give the mass,
and the speed of the pull. Large λ is slow pull, small λ fast pull. With damping, the damping
ratio ζ = c / (2 m w) counts too. `stickslip simulate` prints the exact cycle beside the
formulas.

""".splitlines()
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
    yield f"Parameters of the comparison: {finding.block}."
    yield ""
    yield f"![{finding.title}: {finding.verdict}]({PLOTS}/{finding.id}.svg)"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]

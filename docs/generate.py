"""Writes the documents that are made from the code: run it with ``make docs``.

With ``--check`` it writes nothing, names those that are out of date, and exits 1 if there are any.
The verdicts on both FMUs take minutes; what else is named are reports of them, which it reads.
"""

import contextlib
import io
import json
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from drawings import differences
from rules_of_thumb import pages

from fmi.model import Spec
from fmi.table import Variable
from stickslip import build
from stickslip_design.axis import Axis, axis_file_of, example
from stickslip_design.axis.keys import BY_SECTION, KEYS, SECTIONS
from stickslip_design.loop.critical import critical_feed
from stickslip_design.loop.rest import hunting
from stickslip_design.measures.catalogue import (
    ESTIMATE,
    Condition,
    Measure,
    Move,
    catalogue,
    sources,
)
from stickslip_design.measures.moving import applies, with_measure
from stickslip_fmu.laws.named import BUILT_IN, COULOMB_NAME, friction_law
from stickslip_fmu.laws.native_only import NativeOnly
from stickslip_fmu.spec import TABLE, spec_of
from stickslip_units import EXACT, NONE, shown_in, told
from stickslip_verification import (
    Meaning,
    load_cases,
    load_invariants,
    load_mutants,
    meanings,
    verify,
)
from stickslip_verification.drive.description import content_digest
from stickslip_verification.model.verdict import SEQUENCE, Kind
from stickslip_verification.report.files import as_json
from stickslip_verification.suite.sequences import COUNT, SEED

HERE = Path(__file__).parent

KINDS = {
    Kind.CLOSED_FORM: "the exact motion in high precision, and closed forms of the cycle",
    Kind.INVARIANT: "stick, slip, events, energy, mirror, scaling, splitting, rollback, interface",
    Kind.CONVERGENCE: "the observed order of the reference, in its asymptotic range",
    Kind.CROSS_CODE: "the FMU against the reference; both may be wrong alike, so it gives no pass",
}


def main() -> None:
    """Write the documents beside this file, or check them."""
    reports = [file for file in sys.argv[1:] if file != "--check"]
    # What the FMU warns of belongs to its cases.
    with TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()):
        texts = {
            "interface.md": document(interface()),
            "verdict.md": document(verdict(Path(folder), reports)),
            "checks.md": document(checks()),
            "axis-file.md": document(axis_file()),
            "cures.md": document(cures()),
            **pages(),
        }
    if "--check" in sys.argv:
        if old := outdated(HERE, texts):
            sys.exit("\n".join(("out of date, run `make docs`:", *old)))
        return
    for name, text in texts.items():
        (HERE / name).write_text(text, encoding="utf-8", newline="\n")


def outdated(folder: Path, texts: Mapping[str, str]) -> list[str]:
    """Return which files of a folder are missing or hold another text or picture, and where.

    Plots are compared by what they show: rounding may differ from machine to machine.
    """
    old = []
    for name, text in texts.items():
        file = folder / name
        if file.suffix == ".svg":
            old += differences(file, text)
        elif not file.is_file() or file.read_bytes() != text.encode():
            old.append(f"{file} holds another text")
    return old


def document(lines: Iterator[str]) -> str:
    """Give the text of one document."""
    return "<!-- Made by `make docs`; do not edit. -->\n" + "\n".join(lines) + "\n"


def interface() -> Iterator[str]:
    """Give the lines of the interface page: the variable table."""
    yield from """\
# The FMU's interface

For everybody who connects the FMU in a system simulator. This page lists its variables:
name, unit, range, and when each may be set. It is made from the variable table of the FMU.

- The standard is FMI 2.0 co-simulation, the model identifier `StickSlip`; that of the FMU of
  another friction law is at the end.
- An annotation of the type `org.stickslip.contract` names the contract, `stickslip-exact` in
  version 1: this interface with its start values, and the exact motion to rounding.
- All values are in SI units. Tools may show mm, mm/s and N/mm instead.
- Positions, velocities and forces are positive along the way, in the direction of a positive `v`.
  `F_friction` is the force on the mass: negative in a forward slip, `-(F + F_ext)` in stick.
- A fixed parameter is set before the start.
- A tunable parameter or an input is set at any time, acts from the start of the next step on, and
  holds over it. Outputs show the state at the end of the last step.
- A step may be 1e-13 s or hold many cycles. One with more than 2^24 transitions is refused.
- Bad input (k ≤ 0, NaN, a load that lifts the mass, a step ≤ 0) fails the call. The message has
  name, value and range; it goes to the log, and from the Python FMU to standard error. After a
  failure every call but reset, free and setting a state fails; reset recovers, and so does a state.
- The state can be got, set, serialized and restored in any phase, bit for bit.
- Instances are independent: hundreds of them, threads, or two versions in one process.
- The equations behind the variables are in [theory.md](theory.md).
""".splitlines()
    yield from _variables(TABLE.rows)
    for law in BUILT_IN:
        spec = spec_of(friction_law(law).law)
        if law != COULOMB_NAME:
            yield from _other_interface(law, spec)


def axis_file() -> Iterator[str]:
    """Give the lines of the page of the axis file: its keys, section by section."""
    yield from """\
# The axis file

For designers who describe a feed axis for `stickslip design` and `stickslip reversal`. This page
lists what the file may say. It is made from the table that the commands read with.

- The file is TOML. A number carries its unit, as text: `"50 N/um"`, `"5 mm/min"`, `"60 kg cm2"`,
  `"1.5 m/min/mm"`. A number without unit is a coefficient or a ratio.
- Where the range has a ±, a tolerance may follow: `"50 N/um ± 5 N/um"` or `"50 N/um ± 10 %"`; `+-`
  does as well. Percent are of the value, unless that is in percent itself.
- Forces, dampings and the inertia of a drive are stated at the slide (`N`, `N s/m`, `kg`) or at
  the motor (`N m`, `N m s/rad`, `kg cm2`).
- `drive.kind` says what is between motor and table. A rotary table is stated in degrees and N m, as
  the [last table](#belt-and-rotary) lists. `stickslip design --template --kind belt` or `rotary`
  writes a file of its keys.
- What the file does not state is assumed as listed, and the report says so.
- A key in bold must be stated, or what may stand in its place.

The axis of [feed-axis.md](feed-axis.md):

```toml""".splitlines()
    yield from example().rstrip().splitlines()
    yield "```"
    for section in SECTIONS.values():
        yield from ("", f"## `{section.header}`", "", section.meaning, "")
        if section.otherwise:
            yield from (f"Without it: {section.otherwise}; {section.reason}.", "")
        yield "| key | example | range | what it is | without it |"
        yield "|---|---|---|---|---|"
        for key in BY_SECTION[section.name].values():
            name = f"**`{key.name}`**" if key.required else f"`{key.name}`"
            marks = ", ".join(key.marks("`"))
            meaning = key.meaning + (f" With `{key.needs}` only." if key.goes_with else "")
            taken = ": ".join(filter(None, (key.taken, key.reason)))
            yield f"| {name} | `{key.example}` | {marks} | {meaning} | {taken} |"
    yield from """
## Belt and rotary

What is otherwise with `kind = "belt"` and `kind = "rotary"`. Of a rotary table torques, dampings
and the inertia in `[drive]` are those at the motor, before the gear; all else is at the table.

| key | kind | example | what it is | without it |
|---|---|---|---|---|""".splitlines()
    for key in KEYS.values():
        for kind in key.by_kind:
            other = key.of(kind)
            differs = (other.units, other.meaning, other.taken) != (
                key.units,
                key.meaning,
                key.taken,
            )
            if other.fits(kind) and differs:
                meaning = other.meaning if other.meaning != key.meaning else ""
                yield f"| `{key.path}` | {kind} | `{other.example}` | {meaning} | {other.taken} |"


_OF = {
    "critical_feed": "the critical feed",
    "hunting.dead_band": "the smallest dead band that ends hunting",
}


def cures() -> Iterator[str]:
    """Give the lines of the page of measures: cures.md.in with the catalogue."""
    axis = axis_file_of(example()).axis()
    limit, hunts = _left(axis)
    rows = [
        "| name | measure | effort | moves | jumps up to [mm/s] | hunts by [µm] |",
        "|---|---|---|---|---|---|",
    ]
    terms = [
        "| name | goes with, and needs | costs | does not help |",
        "|---|---|---|---|",
    ]
    for name, one in catalogue().items():
        moves = "<br>".join(_move(move) for move in one.moves) or "the way to the feed"
        left = " | ".join(_tried(one, axis))
        rows.append(f"| `{name}` | {one.name} | {one.effort} | {moves} | {left} |")
        needs = "; ".join((*(map(_condition, one.when)), *filter(None, (one.needs,))))
        terms.append(f"| `{name}` | {needs} | {one.costs} | {one.idle} |")
    yield from (HERE / "cures.md.in").read_text(encoding="utf-8").rstrip().format(
        before=limit, hunting=hunts, catalogue="\n".join(rows), terms="\n".join(terms),
        sources="\n".join(f"- **{name}**: {text}" for name, text in sources().items()),
    ).splitlines()  # fmt: skip


def _left(axis: Axis) -> tuple[str, str]:
    """Give up to which feed an axis jumps [mm/s], and by how much it hunts [µm]."""
    feed, cycle = critical_feed(axis), hunting(axis)
    assert axis.drive is not None
    ends = cycle is None or cycle.dead_band <= axis.drive.dead_band
    hunts = "no" if cycle is None or ends else f"{cycle.jump * 1e6:.1f}"
    return shown_in(feed, "m/s") if feed else "never", hunts


def _tried(one: Measure, axis: Axis) -> tuple[str, str]:
    cycle = hunting(axis)
    now = {
        "critical_feed": critical_feed(axis),
        "hunting.dead_band": cycle.dead_band if cycle else 0.0,
    }
    with_it = with_measure(axis, one, one.steps - 1, now) if applies(one, axis) else None
    return (NONE, NONE) if with_it is None or one.effort == "program" else _left(with_it)


def _move(move: Move) -> str:
    key, name = KEYS[move.key], move.key.partition(".")[2]
    texts = [
        f"{value:.3g}" if isinstance(value, float) and (move.how == "scale" or move.of)
        else told(value, key.units[0], EXACT) if isinstance(value, float)
        else value
        for value in move.values
    ]  # fmt: skip
    sign = {"set": "=", "scale": "×", "add": "+"}[move.how]
    of = f" × {_OF.get(move.of, move.of.rpartition('.')[2])}" if move.of else ""
    source = ESTIMATE if move.source == ESTIMATE else f"[{move.source}]"
    said = "; ".join(filter(None, (move.range, source)))
    return f"`{name}` {sign} {' or '.join(texts)}{of} ({said})"


def _condition(one: Condition) -> str:
    name = one.key.partition(".")[2]
    if one.text:
        return f'`{name} = "{one.text}"`'
    if one.none_of:
        return f"`{name}` not {' or '.join(one.none_of)}"
    ends = (("above", one.above), ("below", one.below))
    return f"`{name}` {' and '.join(f'{side} {end:g}' for side, end in ends if end is not None)}"


def _other_interface(law: str, spec: Spec) -> Iterator[str]:
    """Give the lines on the FMU of another friction law: in what its variables differ."""
    own = spec.table.by_name
    lacking = [f"`{name}`" for name in TABLE.by_name if name not in own]
    native = " --native" if isinstance(friction_law(law).law, NativeOnly) else ""
    yield from f"""\

## {spec.name}

{spec.description} `stickslip build --law {law}{native}` builds it.

It has the variables above with the same names, units and value references, but for
{", ".join(lacking)}. So in a system of FMUs it takes the place of `StickSlip`, and nothing has
to be connected anew.
These are its own:
""".splitlines()
    yield from _variables(row for row in spec.table.rows if row.name not in TABLE.by_name)


def _variables(rows: Iterable[Variable]) -> Iterator[str]:
    """Give the lines of a table of variables."""
    yield ""
    yield "| variable | type | unit | causality | variability | start | range | what it is |"
    yield "|---|---|---|---|---|---|---|---|"
    for row in rows:
        start = "" if row.start is None else f"{row.start:g}"
        cells = (
            f"`{row.name}`",
            row.kind,
            row.unit,
            row.causality,
            row.variability,
            start,
            row.range.partition("finite and ")[2],
            row.description,
        )
        yield "| " + " | ".join(cells) + " |"


def verdict(folder: Path, reports: Iterable[str]) -> Iterator[str]:
    """Give the lines of the verdict page: kinds of truth, cases, how many checks of each hold.

    Without reports, the FMU of each friction law is built in the folder, and verified.
    """
    # Those of a law that is native alone are of the machine that they are built on.
    laws = [law for law in BUILT_IN if not isinstance(friction_law(law).law, NativeOnly)]
    cases = [case for case in load_cases() if case.law in laws]
    fmus = [build(folder, law=law) for law in laws]
    results = [json.loads(Path(file).read_text(encoding="utf-8")) for file in reports] or [
        as_json(verify(fmu, cases, sequences=COUNT)) for fmu in fmus
    ]
    if [each["provenance"]["fmu"]["content"] for each in results] != [*map(content_digest, fmus)]:
        sys.exit(f"{', '.join(reports)}: not the reports of the FMUs that are built here")
    counts = sum((Counter(result["summary"]) for result in results), Counter[str]())
    of_all = [check for result in results for check in result["checks"]]
    drawn = [check for check in of_all if check["case"].startswith(SEQUENCE)]
    cases_of = ({check["case"] for check in result["checks"]} for result in results)
    random = sum(case.startswith(SEQUENCE) for of in cases_of for case in of)
    yield from f"""\
# The verdict

For everybody who must decide whether to trust the FMUs. This page counts what was checked,
in which cases, and with what result.

**{counts["passed"]} passed, {counts["failed"]} failed**, in {len(cases)} cases
and {random} random sequences.

This is code and solution verification in the terms of ASME V&V 10. It shows that the FMUs
and the reference solve the equations of [theory.md](theory.md), and how exactly. Whether
these equations describe a real machine is validation. Validation needs experiments; none
were made here.

| kind of truth | what it is | passed | failed |
|---|---|---|---|
""".splitlines()
    for kind, what in KINDS.items():
        of_kind = [result["by_kind"].get(kind, Counter()) for result in results]
        passed, failed = (sum(each[how] for each in of_kind) for how in ("passed", "failed"))
        yield f"| `{kind}` | {what} | {passed} | {failed} |"
    yield from f"""\

- [checks.md](checks.md) says what the failure of each check means.
- `stickslip verify` writes `report/index.html`: every comparison with its truth, error,
  tolerance and reason.
- `python -m stickslip_verification faults` tests the suite itself: it runs
  {len(load_mutants())} planted faults, and each must fail a check that was named in advance.

The table counts, for each case, the checks that passed on the FMU and on the reference.

| case | what | FMU | reference |
|---|---|---|---|
""".splitlines()
    for case in cases:
        of_case = [check for check in of_all if check["case"] == case.id]
        sides = " | ".join(_holding(of_case, side) for side in ("fmu", "reference"))
        yield f"| `{case.id}` | {case.title} | {sides} |"
    yield f"| | random sequences of seed {SEED} | {_holding(drawn, 'fmu')} | – |"
    of_fmu = [check for check in of_all if not check["case"]]
    held = _holding(of_fmu, "fmu")
    yield f"| | the FMUs themselves: their declarations, refusals, messages and calls | {held} | |"


def checks() -> Iterator[str]:
    """Give the lines of the catalogue: each check, its meaning and the likeliest bug."""
    cases, invariants, faults = load_cases(), load_invariants(), load_mutants()
    known = meanings(cases, invariants)
    detected: dict[str, int] = {}
    for fault in faults:
        for check in fault.detected_by:
            detected[check] = detected.get(check, 0) + 1
    yield from """\
# The checks

For everybody whose FMU failed a check. For each check this page says what its failure
means for a user of the FMU, and which bug is the likeliest.

- Numbers in brackets are the equations of [theory.md](theory.md).
- A check of class `physics` has a tolerance and decides for every FMU.
- A check of class `contract` decides for an FMU that is held to the exact contract: its
  description names `stickslip-exact 1`, or `--contract exact` says so. For any other FMU it
  is noted, and decides with `--strict`.
- The last column counts the planted faults whose description names this check. A planted
  fault must fail at least one of the checks that it names.

## Invariants, checked in every case

| check | statement | kind, class | (eq.) | a failure means | likeliest bug | faults |
|---|---|---|---|---|---|---|
""".splitlines()
    for invariant in invariants:
        cells = (
            f"`{invariant.id}`",
            invariant.title,
            f"{invariant.kind}, {invariant.klass}",
            f"({invariant.source})",
            invariant.means,
            invariant.look,
            str(detected.get(invariant.id, "")),
        )
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
    yield from """\

## Checks of single cases

Each check compares one quantity with the exact motion or with a closed form. A name that
ends in `-course` is compared at every communication point.

| check | cases | a failure means | likeliest bug | faults |
|---|---|---|---|---|
""".splitlines()
    counted: dict[str, int] = {}
    for case in cases:
        for each in case.checks:
            counted[each.id] = counted.get(each.id, 0) + 1
    for check in sorted(counted):
        yield _catalogued(check, counted[check], known[check], detected.get(check))


def _catalogued(check: str, cases: int, meaning: Meaning, faults: int | None) -> str:
    cells = (f"`{check}`", str(cases), meaning.means, meaning.look, str(faults or ""))
    return "| " + " | ".join(cells) + " |"


def _holding(checks: list[dict[str, Any]], side: str) -> str:
    of_side = [check["passed"] for check in checks if check["side"] == side]
    return f"{sum(of_side)} of {len(of_side)}"


if __name__ == "__main__":
    main()

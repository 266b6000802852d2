"""The verdict in words, for the templates of the pages; as JSON; and as JUnit XML for CI."""

import json
import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any, Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup
from pydantic_core import to_jsonable_python

from ..model.data_file import write_whole
from ..model.verdict import (
    CheckResult,
    Kind,
    Measure,
    Outcome,
    Verdict,
    count,
    error_text,
    value_text,
)

KINDS: Final = {kind: kind.replace("_", " ") for kind in Kind} | {Kind.CROSS_CODE: "cross-code"}

SIDES: Final = {"fmu": "FMU", "reference": "reference", "both": "both"}


def measure(result: CheckResult) -> str:
    """Say what the error of a result is a part of, or in which unit it is."""
    parts = {Measure.RELATIVE: "of value", Measure.OF_SCALE: "of scale"}
    return parts.get(result.measure, result.unit if result.unit != "1" else "")


def story(result: CheckResult) -> str:
    """Say in one line why a result is not a plain pass; "" where it is one."""
    if result.verdict == Outcome.PASS:
        return ""
    if result.not_applicable is not None:
        return result.not_applicable
    if result.failure is not None:
        return result.failure
    allowed = f"{error_text(result.tolerance)} {measure(result)}".strip()
    return f"error {error_text(result.error)} is above {allowed}"


def with_exact_motion(verdict: Verdict) -> list[CheckResult]:
    """Return what compares an output of the FMU with the exact motion, in parts of its scale."""
    return [
        result
        for result in verdict.checks
        if result.side == "fmu"
        and result.truth == Kind.CLOSED_FORM
        and result.measure == Measure.OF_SCALE
        and result.verdict == Outcome.PASS
    ]


_TEMPLATES: Final = Path(__file__).parent / "templates"


def environment(folder: Path = _TEMPLATES) -> Environment:
    """Return what renders the templates of a folder, which may take from our own, `parts.html.j2`.

    A name that is missing is an error, text is escaped.
    """
    made = Environment(
        loader=FileSystemLoader([folder, _TEMPLATES]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters |= {
        "slug": lambda word: "-".join(str(word).lower().split()),
        "value": value_text,
        "error": error_text,
        "margin": lambda result: error_text(result.margin),
        "farthest": lambda results: max(results, key=lambda r: r.margin or 0.0, default=None),
        "counts": count,
        "measure": measure,
        "story": story,
        "compared": with_exact_motion,
        "slope": lambda slope: f"{slope:.2f}".replace("-", "\N{MINUS SIGN}"),
    }
    made.tests["finite"] = math.isfinite
    made.globals |= {"kinds": KINDS, "sides": SIDES}
    return made


def text_of(name: str, folder: Path = _TEMPLATES) -> Markup:
    """Return a script that stands in a page as it is, or a style behind that of all documents."""
    files = [_TEMPLATES / "document.css"] * name.endswith(".css") + [folder / name]
    return Markup("".join(file.read_text(encoding="utf-8") for file in files))


def as_json(verdict: Verdict) -> dict[str, Any]:
    """Return the verdict as plain JSON values: summary, by_kind, checks and what is with them.

    A number that is not finite becomes null. A check without anything to compare has null for
    ``got`` and ``error``, and its ``because`` starts with what happened.
    """
    kills, rows = verdict.kills, []
    for result in verdict.checks:
        row = vars(result) | {"class": result.klass, "verdict": result.verdict}
        if result.failure is not None:
            row["because"] = f"{result.failure} (the tolerance: {result.because})"
        rows.append({key: row[key] for key in row if key not in ("klass", "late")})
    values = {
        "summary": verdict.summary,
        "passed": verdict.passed,
        "by_kind": verdict.by_kind,
        "checks": rows,
        "orders": verdict.orders,
        "kills": kills and {"passed": kills.passed, **vars(kills)},
        "contract": verdict.contract,
        "tables": verdict.tables,
        "provenance": verdict.provenance,
    }
    plain: dict[str, Any] = to_jsonable_python(values, inf_nan_mode="null")
    return plain


def json_text(verdict: Verdict) -> str:
    """Return `as_json` as the text of a file."""
    return json.dumps(as_json(verdict), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_json(verdict: Verdict, path: Path) -> None:
    """Write `as_json` to `path`, making its folder; an interrupted write leaves the old file."""
    write_whole(path, json_text(verdict))


ABOUT_THE_FMU = "the FMU"  # class name of the checks that belong to no case
THE_VERDICT = "the verdict"  # class name of what a verdict needs beyond its checks

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def as_junit(verdict: Verdict) -> str:
    """Return one test suite per case and one test case per check and side.

    What does not apply is skipped, and a noted failure, which does not decide, passes with its
    story as output. The last suite has what a verdict needs beyond its checks: a truth that was
    met, and faults caught. There are no times, so that the same verdict gives the same file.
    """
    root = ET.Element("testsuites", name="stickslip verify")
    suites: dict[str, ET.Element] = {}

    def add(suite: str, name: str, tag: str = "", text: str = "", **said: str) -> None:
        if suite not in suites:
            suites[suite] = ET.SubElement(root, "testsuite", name=suite)
        test = ET.SubElement(suites[suite], "testcase", classname=suite, name=name)
        if tag:
            ET.SubElement(test, tag, said).text = text

    for result in verdict.checks:
        of = result.case or ABOUT_THE_FMU, f"{result.check} ({SIDES[result.side]})"
        if result.not_applicable is not None:
            add(*of, "skipped", message=result.not_applicable)
        elif result.failed:
            add(*of, "failure", _numbers(result), type=result.truth, message=story(result))
        elif result.verdict == Outcome.NOTED:
            add(*of, "system-out", f"noted, does not decide: {story(result)}\n{_numbers(result)}")
        else:
            add(*of)
    rows = {"the FMU met a truth": "" if verdict.proven else "no check against a truth passed"}
    if verdict.kills is not None:
        for fault in verdict.kills.rows:
            missed = f"none of {', '.join(fault.wanted)} failed"
            rows[f"planted fault {fault.mutant}"] = "" if fault.caught else missed
        for check, reason in verdict.kills.kills_nothing.items():
            missed = "nothing says why it stays"
            rows[f"kills_nothing check {check}"] = "" if reason else missed
    for name, missed in rows.items():
        add(THE_VERDICT, name, "failure" if missed else "", type="verdict", message=missed)
    properties = ET.Element("properties")
    for name, value in (("contract", verdict.contract.name), ("why", verdict.contract.why)):
        ET.SubElement(properties, "property", name=name, value=value)
    suites[THE_VERDICT].insert(0, properties)
    for suite in (root, *root):
        for attribute, tag in (("tests", "testcase"), ("failures", "failure"), ("skipped",) * 2):
            suite.set(attribute, str(len(list(suite.iter(tag)))))
        suite.set("errors", "0")
    ET.indent(root)
    # An FMU's message may contain what XML cannot hold.
    text = _NOT_IN_XML.sub("\N{REPLACEMENT CHARACTER}", ET.tostring(root, encoding="unicode"))
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _numbers(result: CheckResult) -> str:
    return (
        f"quantity: {result.quantity} [{result.unit}]\n"
        f"expected: {result.expected!r}\n"
        f"got: {result.got!r}\n"
        f"error: {result.error!r}\n"
        f"tolerance: {result.tolerance!r} ({result.measure.replace('_', ' ')})\n"
        f"because: {result.because}\n"
        f"kind of truth: {KINDS[result.truth]}\n"
    )

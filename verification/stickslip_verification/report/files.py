"""The verdict as JSON that any program reads, and as JUnit XML in the layout of CI systems."""

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

from pydantic_core import to_jsonable_python

from stickslip_verification.model.data_file import write_whole
from stickslip_verification.model.verdict import CheckResult, Outcome, Verdict
from stickslip_verification.report.environment import KINDS, SIDES, story


def as_json(verdict: Verdict) -> dict[str, Any]:
    """Return the verdict as plain JSON values: summary, by_kind, checks and what is with them.

    A number that is not finite becomes null. A check without anything to compare has null for
    ``got`` and ``error``, and its ``because`` starts with what happened.
    """
    kills = verdict.kills
    values = {
        "summary": verdict.summary,
        "passed": verdict.passed,
        "by_kind": verdict.by_kind,
        "checks": [_row(result) for result in verdict.checks],
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


def _row(result: CheckResult) -> dict[str, Any]:
    row = vars(result) | {"class": result.klass, "verdict": result.verdict}
    if result.failure is not None:
        row["because"] = f"{result.failure} (the tolerance: {result.because})"
    return {key: value for key, value in row.items() if key not in ("klass", "late")}


ABOUT_THE_FMU = "the FMU"  # class name of the checks that belong to no case
THE_VERDICT = "the verdict"  # class name of what a verdict needs beyond its checks

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def as_junit(verdict: Verdict) -> str:
    """Return one test suite per case and one test case per check and side.

    What does not apply is skipped, and a noted failure, which does not decide, passes with its
    story as output. There are no times, so that the same verdict gives the same file.
    """
    root = ET.Element("testsuites", name="stickslip verify")
    cases: dict[str, ET.Element] = {}
    for result in verdict.checks:
        case = result.case or ABOUT_THE_FMU
        if case not in cases:
            cases[case] = ET.SubElement(root, "testsuite", name=case)
        _add(cases[case], result)
    _add_verdict(root, verdict)
    for suite in (root, *root):
        for attribute, tag in (("tests", "testcase"), ("failures", "failure"), ("skipped",) * 2):
            suite.set(attribute, str(len(list(suite.iter(tag)))))
        suite.set("errors", "0")
    ET.indent(root)
    # An FMU's message may contain what XML cannot hold.
    text = _NOT_IN_XML.sub("\N{REPLACEMENT CHARACTER}", ET.tostring(root, encoding="unicode"))
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _add_verdict(root: ET.Element, verdict: Verdict) -> None:
    """Add what a verdict needs beyond its checks: a truth that was met, and faults caught."""
    rows = {"the FMU met a truth": "" if verdict.proven else "no check against a truth passed"}
    if verdict.kills is not None:
        for fault in verdict.kills.rows:
            missed = f"none of {', '.join(fault.wanted)} failed"
            rows[f"planted fault {fault.mutant}"] = "" if fault.caught else missed
        for check, reason in verdict.kills.kills_nothing.items():
            missed = "nothing says why it stays"
            rows[f"kills_nothing check {check}"] = "" if reason else missed
    suite = ET.SubElement(root, "testsuite", name=THE_VERDICT)
    properties = ET.SubElement(suite, "properties")
    for name, value in (("contract", verdict.contract.name), ("why", verdict.contract.why)):
        ET.SubElement(properties, "property", name=name, value=value)
    for name, reason in rows.items():
        test = ET.SubElement(suite, "testcase", classname=THE_VERDICT, name=name)
        if reason:
            ET.SubElement(test, "failure", type="verdict", message=reason)


def _add(suite: ET.Element, result: CheckResult) -> None:
    name = f"{result.check} ({SIDES[result.side]})"
    test = ET.SubElement(suite, "testcase", classname=suite.attrib["name"], name=name)
    numbers = (
        f"quantity: {result.quantity} [{result.unit}]\n"
        f"expected: {result.expected!r}\n"
        f"got: {result.got!r}\n"
        f"error: {result.error!r}\n"
        f"tolerance: {result.tolerance!r} ({result.measure.replace('_', ' ')})\n"
        f"because: {result.because}\n"
        f"kind of truth: {KINDS[result.truth]}\n"
    )
    if result.not_applicable is not None:
        ET.SubElement(test, "skipped", message=result.not_applicable)
    elif result.failed:
        ET.SubElement(test, "failure", type=result.truth, message=story(result)).text = numbers
    elif result.verdict == Outcome.NOTED:
        said = f"noted, does not decide: {story(result)}\n{numbers}"
        ET.SubElement(test, "system-out").text = said

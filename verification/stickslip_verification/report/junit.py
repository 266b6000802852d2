"""The verdict as JUnit XML, in the layout that CI systems read."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence

from stickslip_verification.model.verdict import CheckResult, Outcome, Verdict
from stickslip_verification.report.words import KINDS, SIDES, what_happened

ABOUT_THE_FMU = "the FMU"
"""Class name of the checks that belong to no case."""

THE_VERDICT = "the verdict"
"""Class name of what a verdict needs beyond its checks."""

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def as_junit(verdict: Verdict) -> str:
    """Return one test suite per case and one test case per check and side.

    What does not apply is skipped, and a noted failure, which does not decide, passes with its
    story as output. There are no times, so that the same verdict gives the same file.
    """
    cases: dict[str, list[CheckResult]] = {}
    for result in verdict.checks:
        cases.setdefault(result.case or ABOUT_THE_FMU, []).append(result)
    root = ET.Element("testsuites", {"name": "stickslip verify"} | _counts(verdict.checks))
    for case, results in cases.items():
        suite = ET.SubElement(root, "testsuite", {"name": _clean(case)} | _counts(results))
        for result in results:
            _add(suite, case, result)
    _add_verdict(root, verdict)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _add_verdict(root: ET.Element, verdict: Verdict) -> None:
    """Add what a verdict needs beyond its checks: a truth that was met, and faults caught."""
    rows = [("the FMU met a truth", "" if verdict.proven else "no check against a truth passed")]
    if verdict.kills is not None:
        for fault in verdict.kills.rows:
            wanted = f"none of {', '.join(fault.wanted)} failed"
            rows.append((f"planted fault {fault.mutant}", "" if fault.caught else wanted))
        for check, reason in verdict.kills.kills_nothing.items():
            rows.append(
                (f"kills_nothing check {check}", "" if reason else "nothing says why it stays")
            )
    wrong = sum(bool(reason) for _, reason in rows)
    counts = {"tests": str(len(rows)), "failures": str(wrong), "errors": "0", "skipped": "0"}
    suite = ET.SubElement(root, "testsuite", {"name": THE_VERDICT} | counts)
    properties = ET.SubElement(suite, "properties")
    for name, value in (("contract", verdict.contract.name), ("why", verdict.contract.why)):
        ET.SubElement(properties, "property", name=name, value=_clean(value))
    for name, reason in rows:
        test = ET.SubElement(suite, "testcase", classname=THE_VERDICT, name=_clean(name))
        if reason:
            ET.SubElement(test, "failure", type="verdict", message=_clean(reason))
    for key in ("tests", "failures"):
        root.set(key, str(int(root.get(key, "0")) + int(counts[key])))


def _counts(results: Sequence[CheckResult]) -> dict[str, str]:
    return {
        "tests": str(len(results)),
        "failures": str(sum(result.failed for result in results)),
        "errors": "0",
        "skipped": str(sum(result.not_applicable is not None for result in results)),
    }


def _add(suite: ET.Element, case: str, result: CheckResult) -> None:
    name = f"{result.check} ({SIDES.get(result.side, result.side)})"
    test = ET.SubElement(suite, "testcase", classname=_clean(case), name=_clean(name))
    if result.not_applicable is not None:
        ET.SubElement(test, "skipped", message=_clean(result.not_applicable))
    elif result.failed:
        failure = ET.SubElement(
            test, "failure", type=result.truth, message=_clean(what_happened(result))
        )
        failure.text = _clean(_story(result))
    elif result.verdict == Outcome.NOTED:
        output = ET.SubElement(test, "system-out")
        output.text = _clean(f"noted, does not decide: {what_happened(result)}\n{_story(result)}")


def _story(result: CheckResult) -> str:
    return (
        f"quantity: {result.quantity} [{result.unit}]\n"
        f"expected: {result.expected!r}\n"
        f"got: {result.got!r}\n"
        f"error: {result.error!r}\n"
        f"tolerance: {result.tolerance!r} ({result.measure.replace('_', ' ')})\n"
        f"because: {result.because}\n"
        f"kind of truth: {KINDS.get(result.truth, result.truth)}\n"
    )


def _clean(text: str) -> str:
    """Replace what XML cannot hold: an FMU's message may contain anything."""
    return _NOT_IN_XML.sub("\N{REPLACEMENT CHARACTER}", text)

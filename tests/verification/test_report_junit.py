"""The verdict as JUnit XML: what a CI system counts is what the verdict says."""

import xml.etree.ElementTree as ET

from stickslip_verification.model.verdict import ChosenContract, Second, Verdict
from stickslip_verification.report.junit import as_junit
from tests.verification.test_report import result

RESULTS = [
    result(),
    result(side="reference", error=3e-3, passed=False),
    result(case="tuned", passed=False, decides=False, error=1.0, klass="contract"),
    result(case="tuned", passed=False, not_applicable="no slip", got=None, error=None),
    result(case="", check="units", second=Second(1.0, 2.0, drift=1.0, tolerance=1e-9)),
]


def test_every_result_is_one_test_case() -> None:
    """Suites are cases, test cases are checks with their side, and all counts agree."""
    root = ET.fromstring(as_junit(Verdict(RESULTS)))
    assert root.tag == "testsuites"
    assert [suite.get("name") for suite in root] == ["default", "tuned", "the FMU", "the verdict"]
    assert root.find("testsuite/testcase").attrib == {  # type: ignore[union-attr]
        "classname": "default",
        "name": "t_slip-exact (FMU)",
    }
    for group in (root, *root):
        cases = list(group.iter("testcase"))
        failures = [case for case in cases if case.find("failure") is not None]
        skipped = [case for case in cases if case.find("skipped") is not None]
        counted = [int(group.get(name, "")) for name in ("tests", "failures", "skipped")]
        assert counted == [len(cases), len(failures), len(skipped)]
        assert group.get("errors") == "0"


def test_each_verdict_has_its_element() -> None:
    """What failed or drifted fails, what does not apply is skipped, what is noted passes."""
    root = ET.fromstring(as_junit(Verdict(RESULTS)))
    found = [[child.tag for child in case] for case in root.iter("testcase")]
    assert found == [[], ["failure"], ["system-out"], ["skipped"], ["failure"], []]
    failure = next(root.iter("failure"))
    assert failure.get("message") == "error 0.003 is above 1e-12 s"
    assert "because: rounding" in str(failure.text)
    assert next(root.iter("skipped")).get("message") == "no slip"


def test_the_layout_is_the_one_that_readers_know() -> None:
    """No element has a child or an attribute that the common readers of JUnit do not expect."""
    children = {
        "testsuites": {"testsuite"},
        "testsuite": {"properties", "testcase"},
        "properties": {"property"},
        "testcase": {"failure", "skipped", "system-out"},
    }
    attributes = {
        "testsuites": {"name", "tests", "failures", "errors", "skipped"},
        "testsuite": {"name", "tests", "failures", "errors", "skipped"},
        "properties": set(),
        "property": {"name", "value"},
        "testcase": {"classname", "name"},
        "failure": {"message", "type"},
        "skipped": {"message"},
    }
    for element in ET.fromstring(as_junit(Verdict(RESULTS))).iter():
        assert {child.tag for child in element} <= children.get(element.tag, set())
        assert set(element.attrib) == attributes.get(element.tag, set())


def test_the_contract_and_its_reason_are_properties_of_the_verdict() -> None:
    """A CI system shows which contract was kept, and why that one."""
    chosen = ChosenContract("physics", "--contract physics")
    root = ET.fromstring(as_junit(Verdict(RESULTS, contract=chosen)))
    suite = root.find("testsuite[@name='the verdict']")
    assert suite is not None
    assert suite[0].tag == "properties"
    assert {each.get("name"): each.get("value") for each in suite[0]} == {
        "contract": "physics",
        "why": "--contract physics",
    }


def test_a_message_of_an_fmu_cannot_break_the_file() -> None:
    """Control characters, lone surrogates and markup in a message leave the XML readable."""
    wild = result(passed=False, got=None, error=None, failure="a\x00b\x1b[31m <&\"'> \ud800 ]]>")
    text = as_junit(Verdict([wild]))
    failure = next(ET.fromstring(text.encode("utf-8")).iter("failure"))
    assert failure.get("message") == "a\ufffdb\ufffd[31m <&\"'> \ufffd ]]>"


def test_the_same_verdict_gives_the_same_file() -> None:
    """Neither time nor place is in the file."""
    here, there = Verdict(RESULTS, {"created": "today"}), Verdict(RESULTS, {"created": "tomorrow"})
    assert as_junit(here) == as_junit(there)

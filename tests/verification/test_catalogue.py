"""The catalogue: what the failure of each check means."""

from __future__ import annotations

from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.run.lint import SHORTEST, VAGUE
from stickslip_verification.suite.cases import load_cases
from stickslip_verification.suite.catalogue import Meaning, meanings, of_quantities
from stickslip_verification.suite.invariants import Laws, load_laws

CASES, LAWS = load_cases(), load_laws()
FOUND = meanings(CASES, LAWS)


def test_every_quantity_has_a_meaning_and_no_other_has() -> None:
    """What a check can be about and what the catalogue explains are the same list."""
    assert set(of_quantities()) == set(QUANTITIES)


def test_every_check_of_a_verdict_has_a_meaning() -> None:
    """Whatever id a result can bear, of a case, a law or an order's range, is explained."""
    wanted = {check.id for case in CASES for check in case.checks} | {law.id for law in LAWS}
    wanted |= {f"{law.id}-asymptotic" for law in LAWS.orders}
    assert set(FOUND) == wanted


def test_a_check_means_what_its_quantity_means() -> None:
    """The meaning of a case's check is that of what it compares, whatever its name."""
    known = of_quantities()
    for case in CASES:
        for check in case.checks:
            assert FOUND[check.id] == known[check.quantity], f"{case.id} / {check.id}"


def test_one_id_is_about_one_quantity() -> None:
    """Checks of one name in several cases are about the same thing, or one would hide another."""
    about: dict[str, set[str]] = {}
    for case in CASES:
        for check in case.checks:
            about.setdefault(check.id, set()).add(check.quantity)
    assert {name: found for name, found in about.items() if len(found) > 1} == {}


def test_a_law_means_what_it_says() -> None:
    """The meaning of a law stands in its file."""
    for law in LAWS:
        assert FOUND[law.id] == Meaning(law.means, law.look)


def test_a_meaning_says_something() -> None:
    """Both texts of every meaning are sentences of some length without a vague word."""
    for name, meaning in FOUND.items():
        for text in (meaning.means, meaning.look):
            assert len(text) >= SHORTEST, name
            assert text.endswith("."), name
            assert not [word for word in VAGUE if word in text.lower().split()], name


def test_nothing_needs_no_explanation() -> None:
    """No cases and no laws give no meanings."""
    assert meanings([], Laws()) == {}

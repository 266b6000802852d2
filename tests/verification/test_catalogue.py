"""The catalogue: what the failure of each check means."""

from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.run.lint import SHORTEST, VAGUE
from stickslip_verification.suite.cases import load_cases
from stickslip_verification.suite.catalogue import Meaning, meanings, of_quantities
from stickslip_verification.suite.invariants import Invariants, load_invariants

CASES, INVARIANTS = load_cases(), load_invariants()
FOUND = meanings(CASES, INVARIANTS)


def test_every_quantity_has_a_meaning_and_no_other_has() -> None:
    """What a check can be about and what the catalogue explains are the same list."""
    assert set(of_quantities()) == set(QUANTITIES)


def test_every_check_of_a_verdict_has_a_meaning() -> None:
    """Whatever id a result can bear, of a case, an invariant or an order's range, is explained."""
    wanted = {check.id for case in CASES for check in case.checks} | {
        invariant.id for invariant in INVARIANTS
    }
    wanted |= {f"{invariant.id}-asymptotic" for invariant in INVARIANTS.orders}
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


def test_an_invariant_means_what_it_says() -> None:
    """The meaning of an invariant stands in its file."""
    for invariant in INVARIANTS:
        assert FOUND[invariant.id] == Meaning(invariant.means, invariant.look)


def test_a_meaning_says_something() -> None:
    """Both texts of every meaning are sentences of some length without a vague word."""
    for name, meaning in FOUND.items():
        for text in (meaning.means, meaning.look):
            assert len(text) >= SHORTEST, name
            assert text.endswith("."), name
            assert not [word for word in VAGUE if word in text.lower().split()], name


def test_nothing_needs_no_explanation() -> None:
    """No cases and no invariants give no meanings."""
    assert meanings([], Invariants()) == {}

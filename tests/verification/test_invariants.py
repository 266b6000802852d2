"""The invariants as data: what is read, what is refused, and those of the suite."""

from pathlib import Path

import pytest

from stickslip_verification import InvariantError, load_invariants

INVARIANTS = load_invariants()

RESIDUAL = """\
[residuals.pull]
title = "The pulled end moves at v"
kind = "invariant"
class = "physics"
source = 1
metric = "outputs.pulled_end"
quantity = "way less v h"
tolerance = { fmu = 1e-14, reference = 1e-12 }
because.fmu = "one product and one addition"
because.reference = "one product and one addition"
means = "The input v does not arrive."
look = "The sampling of v."
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("pull", "'no good'", "line 1, residuals.no good.id: 'no good' should match pattern"),
        ('look = "The sampling of v."\n', "", "line 1, residuals.pull.look: is missing"),
        ("source = 1", "source = 1\ncolour = 1", "line 6, .*colour: is no field; there are id"),
        ("fmu = 1e-14, ", "", "tolerance: has the keys reference, and not fmu and reference"),
        (
            RESIDUAL,
            RESIDUAL + "[agreements.pull]\ntitle = 'F'\nquantity = 'F'",
            "agreements.pull: ",
        ),
        ("The pulled", "The p\udcffulled", "is not UTF-8"),
    ],
)
def test_a_broken_invariant_is_refused_by_file_invariant_and_field_in_one_line(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    assert old in RESIDUAL
    file = tmp_path / "invariants.toml"
    file.write_text(RESIDUAL.replace(old, new, 1), encoding="utf-8", errors="surrogateescape")
    with pytest.raises(InvariantError, match=words) as refused:
        load_invariants(tmp_path)
    assert str(refused.value).startswith(f"{file}: ")
    assert "\n" not in str(refused.value)


def test_physics_asks_no_numerical_solution_for_a_digit_it_cannot_keep() -> None:
    strict = {each.id for each in INVARIANTS.residuals if each.tolerance["reference"] == 0.0}
    physics = {each.id for each in INVARIANTS.residuals if each.klass == "physics"}
    assert physics & strict == {"finite", "mode-and-sticking-agree", "runs-to-the-end"}
    of_exact = [each for each in INVARIANTS.runs if not each.numerical]
    assert {each.klass for each in of_exact if each.tolerance is None} == {"contract"}


def test_the_exact_block_is_held_at_least_as_tightly_as_an_integrator() -> None:
    looser = [x.id for x in INVARIANTS.residuals if x.tolerance["fmu"] > x.tolerance["reference"]]
    assert looser == []

"""`stickslip critical`: what its table says, and whose values its friction law takes."""

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from stickslip.commands.laws import table_of_law, values_of_law
from stickslip.errors import CommandError
from stickslip.show.critical_table import critical_table
from stickslip_ref import CriticalVelocity, Interval
from tests.workbench.running import Command

FOUND = CriticalVelocity(
    unstable=(Interval(1e-3, 0.05, "none", "eigenvalue"),),
    cycle=(Interval(1e-3, 0.04, "none", "grazing"), Interval(0.15, 0.38, "reversal", "fold")),
    between=(1e-3, 2.0),
    proven=False,
)


def shown(v: float | None) -> list[str]:
    """Return the lines of the table, their words with one blank between them."""
    console = Console(file=StringIO(), width=120)
    console.print(critical_table(FOUND, v))
    assert isinstance(console.file, StringIO)
    return [" ".join(line.split()) for line in console.file.getvalue().splitlines()]


def test_each_end_has_its_velocity_and_its_kind() -> None:
    """Of each range of both lists."""
    rows = shown(None)
    assert "a cycle with a stick exists 1 mm/s search 40 mm/s grazing" in rows
    assert "150 mm/s reversal 380 mm/s fold" in rows
    assert "steady sliding is unstable 1 mm/s search 50 mm/s eigenvalue" in rows


def test_a_backward_pull_has_the_motions_of_its_speed() -> None:
    """The table tells them at |v|."""
    told = "at 200 mm/s: the mass sticks and slips, or by its start the mass slides evenly"
    assert told in shown(-0.2)
    assert "at 45 mm/s: the mass swings and never sticks" in shown(0.045)


def test_bounds_of_the_search_are_those_typed(command: Command) -> None:
    """Both of them; beyond, no motion is told."""
    typed = ("critical", "--law", "stribeck", "--from", "10mm/s", "--to", "20mm/s")
    answer = command(*typed)
    assert "searched: 10 mm/s to 20 mm/s" in answer.out
    answer = command(*typed, "--v", "30mm/s")
    assert answer.code == 2
    assert answer.err.strip() == (
        "stickslip: v = 0.03 m/s is out of range; the velocities searched are 0.01 to 0.02 m/s"
    )


@pytest.mark.parametrize(("v", "searched"), [("-7m/s", "to 7 m/s"), ("1um/s", "1 µm/s to ")])
def test_the_range_searched_holds_the_velocity_asked_for(
    command: Command, v: str, searched: str
) -> None:
    """Where the usual range does not, and no end of it was typed on that side."""
    answer = command("critical", "--law", "stribeck", "--c", "2", "--v", v)
    assert answer.code == 0
    assert "the mass s" in answer.out
    assert searched in answer.out
    between = ("--from", "1mm/s", "--to", "2m/s")
    assert command("critical", "--law", "stribeck", "--c", "2", "--v", v, *between).code == 2


@pytest.mark.parametrize("verb", ["critical", "simulate"])
def test_a_curve_and_another_law_are_refused(command: Command, tmp_path: Path, verb: str) -> None:
    """Coulomb's too, where it is typed."""
    curve = tmp_path / "curve.csv"
    curve.write_text("speed,mu\n0,0.42\n0.1,0.3\n", encoding="utf-8")
    for law in ("coulomb", "a:B"):
        answer = command(verb, "--curve", str(curve), "--law", law)
        assert answer.code == 2
        assert answer.err.strip() == (
            f"stickslip: --curve goes with --law stribeck, not with --law {law}"
        )


def test_a_curve_sets_the_break_away_coefficient_unless_it_is_typed(tmp_path: Path) -> None:
    """That of speed 0; and what the curve sets is not typed once more."""
    curve = tmp_path / "curve.csv"
    curve.write_text("speed,mu\n0,0.42\n0.1,0.3\n", encoding="utf-8")
    table = table_of_law("stribeck")
    assert values_of_law([], table, curve, None, None)["mu_s"] == "0.42"
    assert "mu_s" not in values_of_law([], table, curve, None, "0.6")
    with pytest.raises(CommandError, match=r"--law-parameter u_2: --curve .* sets it"):
        values_of_law(["u_2=1"], table, curve, None, None)


def test_a_normal_force_goes_with_a_curve_of_forces(tmp_path: Path) -> None:
    """A curve of coefficients takes none, one of forces needs one; the option is named."""
    curve = tmp_path / "curve.csv"
    table = table_of_law("stribeck")
    curve.write_text("speed,mu\n0,0.42\n0.1,0.3\n", encoding="utf-8")
    with pytest.raises(CommandError, match=r"--normal-force: --curve .* has coefficients"):
        values_of_law([], table, curve, "200 N", None)
    curve.write_text("speed,force\n0,84\n0.1,60\n", encoding="utf-8")
    assert values_of_law([], table, curve, "200 N", None)["mu_s"] == "0.42"
    with pytest.raises(CommandError, match=r"--curve .*: line 1: has forces; .* --normal-force"):
        values_of_law([], table, curve, None, None)

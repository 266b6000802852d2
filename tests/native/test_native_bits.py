"""The native block and the Python block are the same arithmetic."""

import math
import random
from collections.abc import Mapping
from pathlib import Path

import pytest

from fmukit.model import Spec
from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.spec import SPEC, spec_of
from tests.native.bits import Draw, bits, draw, sequence, spread
from tests.native.core import Core, compile_core
from tests.needs import needs

FALLING = Path(__file__).parents[1] / "laws" / "falling" / "native"

pytestmark = needs("cc")


def equal_values(
    core: Core, spec: Spec, count: int, draw: Draw = draw, own: tuple[str, ...] = ()
) -> tuple[int, int]:
    """Return how many outputs were equal in `count` sequences, and how often both refused.

    Fails where an output differs in a bit, or one block refuses and the other does not.
    """
    compared = refused = 0
    for seed in range(count):
        for number, (expected, given) in enumerate(sequence(core, spec, seed, draw, own)):
            if expected is None or given is None:
                assert expected is given is None, (seed, number, expected, given)
                refused += 1
                continue
            assert bits(expected) == bits(given), (seed, number, expected, given)
            compared += len(given)
    return compared, refused


def test_both_blocks_show_the_same_bits(tmp_path: Path) -> None:
    """After every step of 5,000 random sequences all outputs of both are equal to the bit."""
    compared, refused = equal_values(Core(compile_core(tmp_path)), SPEC, 5_000)
    assert compared > 1_000_000
    assert 100 < refused < 1_500


def draw_falling(random_: random.Random, name: str, values: Mapping[str, float]) -> float:
    """Return a value of a setting; the fall may be steeper than the damping."""
    if name != "slope":
        return draw(random_, name, values)
    normal = values["m"] * values["g"] + values["load"]
    critical = 2.0 * math.sqrt(values["k"] * values["m"])
    steep = critical / normal * spread(random_, 1e-4, 3.0) if normal > 0.0 else 0.0
    return random_.choice((0.0, steep, 0.01 * steep))


def test_another_law_shows_the_same_bits_too(tmp_path: Path) -> None:
    """A law with another end of slip, given as a folder alone, is equal to its twin in Python."""
    spec = spec_of(friction_law("tests.laws.falling:FALLING").law)
    shared = ("coulomb_slip.c", "coefficients.c")
    library = compile_core(tmp_path, spec=spec, law=FALLING, shared=shared)
    compared, refused = equal_values(Core(library, spec), spec, 1_000, draw_falling, ("slope",))
    assert compared > 100_000
    assert refused > 100


@pytest.mark.parametrize("law", ["coulomb", "falling"])
def test_the_compiler_finds_nothing_to_say(tmp_path: Path, law: str) -> None:
    """Warnings and the static analyser are errors here, and there is none."""
    strict = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Wpedantic", "-fanalyzer")
    flags = (*strict, "-Werror", "-fvisibility=hidden")
    if law == "coulomb":
        compile_core(tmp_path, flags)
    else:
        spec = spec_of(friction_law("tests.laws.falling:FALLING").law)
        shared = ("coulomb_slip.c", "coefficients.c")
        compile_core(tmp_path, flags, spec=spec, law=FALLING, shared=shared)

"""The native block and the Python block are the same arithmetic."""

from collections.abc import Callable
from pathlib import Path

import pytest

from fmukit.model import Spec
from stickslip_fmu.spec import SPEC
from stickslip_native.named import native_law, native_laws
from tests.native.bits import STRIBECK, Draw, bits, draw, draw_stribeck, sequence
from tests.native.core import Core, compile_core
from tests.needs import needs

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


def test_friction_over_speed_shows_the_same_bits_too(
    tmp_path: Path, sized: Callable[[int], int]
) -> None:
    """Curves and smooth shapes, whole exponents and others: 6,000 random sequences."""
    spec = native_law("stribeck").spec
    library = compile_core(tmp_path, spec=spec, law=native_laws()["stribeck"])
    compared, refused = equal_values(
        Core(library, spec), spec, sized(6_000), draw_stribeck, STRIBECK
    )
    assert compared > sized(1_000_000)
    assert refused > sized(200)


@pytest.mark.parametrize("law", ["coulomb", "stribeck"])
def test_the_compiler_finds_nothing_to_say(tmp_path: Path, law: str) -> None:
    """Warnings and the static analyser are errors here, and there is none."""
    strict = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Wpedantic", "-fanalyzer")
    flags = (*strict, "-Werror", "-fvisibility=hidden")
    compile_core(tmp_path, flags, spec=native_law(law).spec, law=native_laws()[law])

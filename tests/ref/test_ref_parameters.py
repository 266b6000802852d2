"""Parameters are checked where they are made."""

import math
import warnings

import numpy as np
import pytest

from stickslip_ref import FrictionClampWarning, Parameters, steady_cycle


@pytest.mark.parametrize(
    ("name", "value", "range_"),
    [
        ("m", 0.0, "finite and > 0 kg"),
        ("g", -9.81, "finite and > 0 m/s2"),
        ("k", -1.0, "finite and > 0 N/m"),
        ("c", -0.1, "finite and >= 0 N.s/m"),
        ("mu_s", -0.5, "finite and >= 0"),
        ("mu_k", math.nan, "finite and >= 0"),
        ("v", math.inf, "finite"),
        ("F_ext", math.nan, "finite"),
        ("x_start", -math.inf, "finite"),
        ("load", -9.82, ">= -m g = -9.81 N"),
    ],
)
def test_bad_values_are_named_with_their_range(name: str, value: float, range_: str) -> None:
    """A value out of range is refused by name, value and range."""
    with pytest.raises(ValueError, match=f"{name} = ") as refusal:
        Parameters(**{name: value})
    assert repr(value) in str(refusal.value)
    assert range_ in str(refusal.value)


def test_the_bad_point_of_an_array_is_named() -> None:
    """In a field of parameters the message says which point is wrong."""
    with pytest.raises(ValueError, match=r"k\[0, 1\] = -3\.0 N/m is out of range"):
        Parameters(k=np.array([[1.0, -3.0]]))


def test_text_is_no_number() -> None:
    """A string is refused as such, whatever it spells."""
    with pytest.raises(ValueError, match="v = '20' is not a number"):
        Parameters(v="20")  # type: ignore[arg-type]  # a wrong type is the point


def test_shapes_that_do_not_broadcast_are_named() -> None:
    """Arrays that do not fit each other are named with their shapes."""
    with pytest.raises(ValueError, match=r"k \(2,\), v \(3,\)"):
        Parameters(k=np.ones(2), v=np.ones(3))


def test_a_kinetic_coefficient_above_the_static_one_is_clamped_with_a_warning() -> None:
    """Kinetic friction does not exceed static friction; the warning names both numbers."""
    with pytest.warns(FrictionClampWarning, match=r"mu_k = 0\.6 exceeds mu_s = 0\.5.* 0\.49"):
        p = Parameters(mu_s=0.5, mu_k=0.6)
    assert p.mu_k_used == 0.5 - 0.01
    assert p.mu_k == 0.6


def test_the_clamp_stops_at_zero() -> None:
    """Where mu_s is below the clamp's gap, kinetic friction vanishes."""
    with pytest.warns(FrictionClampWarning, match="and at 1 more points"):
        p = Parameters(mu_s=np.array([0.005, 0.5, 0.5]), mu_k=np.array([0.1, 0.2, 0.7]))
    np.testing.assert_array_equal(p.mu_k_used, [0.0, 0.2, 0.49])


def test_equal_coefficients_are_allowed() -> None:
    """No gap between static and kinetic friction is a case of its own, without a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert Parameters(mu_s=0.3, mu_k=0.3).Delta == 0.0


def test_no_normal_force_is_allowed() -> None:
    """A mass lifted to no weight is the limit of the load, not beyond it."""
    assert Parameters(m=3.0, load=-3.0 * 9.81).N == 0.0


def test_arrays_are_not_copied_and_not_writable() -> None:
    """A million stiffnesses are shared with the caller, and cannot be changed through here."""
    k = np.linspace(1.0, 2.0, 5)
    p = Parameters(k=k)
    assert np.shares_memory(k, np.asarray(p.k))
    with pytest.raises(ValueError, match="read-only"):
        np.asarray(p.k)[0] = 5.0
    assert k.flags.writeable


def test_equal_parameters_are_equal() -> None:
    """Parameter sets compare by value, arrays included."""
    assert Parameters(k=np.array([1.0, 2.0])) == Parameters(k=np.array([1.0, 2.0]))
    assert Parameters() != Parameters(v=0.03)
    assert hash(Parameters()) == hash(Parameters())
    assert Parameters() != {"k": 1000.0}


def test_a_field_without_points_is_allowed() -> None:
    """An empty array of stiffnesses gives an empty array of cycles."""
    nothing = Parameters(k=np.array([]))
    assert nothing.shape == (0,)
    assert np.shape(steady_cycle(nothing).T) == (0,)


@pytest.mark.parametrize(
    "values", [{"k": 1e308, "m": 1e-308}, {"k": 1e-300, "m": 1e300}, {"k": 1e-320}, {"c": 1e300}]
)
def test_rates_beyond_double_precision_are_refused(values: dict[str, float]) -> None:
    """Stiffness, mass and damping whose rates no double holds are refused, all three named."""
    with pytest.raises(ValueError, match="out of range together; k / m must be") as refusal:
        Parameters(**values)
    for name, value in ({"k": 1000.0, "m": 1.0, "c": 0.0} | values).items():
        assert f"{name} = {value!r}" in str(refusal.value)


def test_rates_are_checked_point_by_point() -> None:
    """A field is refused for a pair of its points that meet, not for one that does not."""
    k, m = np.array([1e-200, 1e200]), np.array([1e-200, 1e200])
    assert Parameters(k=k, m=m).shape == (2,)
    with pytest.raises(ValueError, match=r"k = 1e-200 N/m, m = 1e\+200 kg"):
        Parameters(k=k, m=m[::-1])


def test_a_number_without_a_unit_is_named_without_one() -> None:
    """A friction coefficient is a number; no unit follows it."""
    with pytest.raises(ValueError, match=r"^mu_s = -1\.0 is out of range; it must be finite"):
        Parameters(mu_s=-1.0)

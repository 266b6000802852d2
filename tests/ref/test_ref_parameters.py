"""Parameters of the reference: numbers and arrays, checked where they are made."""

import warnings

import numpy as np
import pytest

from stickslip_ref import FrictionClampWarning, Parameters


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"mu_s": -1.0}, "^mu_s = -1.0 is out of range; it must be finite and >= 0"),
        ({"k": np.array([[1.0, -3.0]])}, r"k\[0, 1\] = -3\.0 N/m is out of range"),
        ({"v": "20"}, "v = '20' is not a number"),
        ({"k": np.ones(2), "v": np.ones(3)}, r"k \(2,\), v \(3,\)"),
        ({"k": 1e308, "m": 1e-308}, "k = 1e[+]308.* m = 1e-308.* out of range together"),
        ({"k": 1e-320}, "out of range together"),
        ({"c": 1e300}, "out of range together"),
        ({"k": np.array([1e-200, 1.0]), "m": np.array([1e200, 1.0])}, "k = 1e-200 N/m, m = 1e[+]2"),
    ],
)
def test_bad_values_are_named_with_their_range(values: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Parameters(**values)


def test_the_rates_of_a_field_are_checked_point_by_point() -> None:
    # The points that do not meet would be out of range.
    k = m = np.array([1e-200, 1e200])
    assert Parameters(k=k, m=m).shape == (2,)


def test_kinetic_friction_above_static_friction_is_clamped_with_one_warning() -> None:
    with pytest.warns(FrictionClampWarning, match=r"mu_k = 0\.1 exceeds.*and at 1 more points"):
        p = Parameters(mu_s=np.array([0.005, 0.5, 0.5]), mu_k=np.array([0.1, 0.2, 0.7]))
    np.testing.assert_array_equal(p.mu_k_used, [0.0, 0.2, 0.49])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert Parameters(mu_s=0.3, mu_k=0.3).Delta == 0.0
        assert Parameters(m=3.0, load=-3.0 * 9.81).N == 0.0


def test_arrays_are_shared_with_the_caller_and_not_writable() -> None:
    k = np.linspace(1.0, 2.0, 5)
    p = Parameters(k=k)
    assert np.shares_memory(k, np.asarray(p.k))
    with pytest.raises(ValueError, match="read-only"):
        np.asarray(p.k)[0] = 5.0
    assert k.flags.writeable

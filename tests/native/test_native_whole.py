"""Laws without a stick in the native block: LuGre, rate and state. docs/theory.md (33) to (36)."""

import math
import random
import re
import tomllib
from dataclasses import fields
from functools import cache
from itertools import pairwise
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest

import stickslip as ss
import stickslip_ref
from stickslip_fmu.laws.named import friction_law
from stickslip_fmu.laws.native_only import NativeOnly
from stickslip_fmu.packer import build
from stickslip_native import packer
from stickslip_native.packer import sources_of
from stickslip_verification.drive import FmuError
from tests.conftest import Sized
from tests.native.compiling import FLAGS, run, with_library, written
from tests.native.core import ACCEPTED, Core, NativeBlock, compile_core
from tests.needs import needs

pytestmark = needs("cc")

G = 9.81
PUBLISHED = {"m": 1.0, "k": 2.0, "v": 0.1, "c": 0.4, "mu_s": 1.5 / G, "mu_k": 1.0 / G,
             "sigma_0": 1e5, "sigma_1": math.sqrt(1e5), "v_s": 1e-3}  # fmt: skip
"""Canudas de Wit et al., IEEE TAC 40 (1995) 419, section IV-D."""
QDYN = {"m": 1.0, "load": 5e6 - G, "k": 2e9, "c": 2e10 / 6000, "a": 0.01, "b": 0.025, "D_c": 1e-5,
        "V_0": 1e-6, "v": 1e-6, "theta_start": 10.0, "inertia": 2.0}  # fmt: skip
"""QDYN's spring block; z_start is such that the first velocity is 2e-5 m/s."""


@cache
def core(law: str) -> Core:
    return Core(compile_core(Path(mkdtemp()), law), law)


def values(law: str, given: dict[str, float]) -> dict[str, float]:
    own = dict(core(law).spec.table.start_values()) | given
    if law == "rate_state" and "z_start" not in given:
        normal = own["m"] * own["g"] + own["load"]
        x_dot = 2e-5 if own["inertia"] == 2.0 else own["v"]
        psi = own["mu_0"] + own["b"] * math.log(own["V_0"] * own["theta_start"] / own["D_c"])
        mu = own["a"] * math.asinh(x_dot / (2.0 * own["V_0"]) * math.exp(psi / own["a"]))
        own |= {"z_start": (normal * mu + own["c"] * x_dot) / own["k"]}
        own["x_dot_start"] = x_dot if own["inertia"] == 1.0 else 0.0
    return own


class Run:
    """A block that is moved and read by name."""

    def __init__(self, law: str, given: dict[str, float]) -> None:
        self.law, self.values, self.time = law, values(law, given), 0.0
        self.block = NativeBlock(core(law), self.values)
        table = core(law).spec.table
        self.names = [row.name for row in table.rows if not row.settable]

    def advance(self, step: float) -> dict[str, float]:
        self.block.advance(self.time, step)
        self.time += step
        read = self.block.outputs()
        assert self.block.refused == ACCEPTED, self.block.refused
        return dict(zip(self.names, read, strict=True))

    def lost(self, now: dict[str, float]) -> float:
        """Return what is missing in the balance of energy, relative to the energies [1]."""
        start = self.values
        stored = 0.5 * start["k"] * (now["z"] ** 2 - start["z_start"] ** 2) + now.get(
            "E_bristles", 0.0
        )
        if start.get("inertia") != 2.0:
            stored += 0.5 * start["m"] * (now["x_dot"] ** 2 - start["x_dot_start"] ** 2)
        scale = abs(now["Q_friction"]) + 0.5 * start["k"] * now["z"] ** 2
        return abs(now["W_pull"] + now["W_k"] - now["Q_friction"] - stored) / scale


def test_lugre_gives_the_published_forces() -> None:
    run, spring, friction = Run("lugre", PUBLISHED), 0.0, 0.0
    for _ in range(20_000):
        now = run.advance(1e-3)
        spring, friction = max(spring, now["F"]), max(friction, -now["F_friction"])
    assert (spring, friction) == pytest.approx((1.508, 1.4765), abs=1e-3)
    assert now["F_s"] == pytest.approx(1.5, rel=1e-15)
    assert run.lost(now) < 1e-10


def test_rate_and_state_gives_the_published_recurrence() -> None:
    run = Run("rate_state", QDYN)
    now = run.advance(9000.0)
    assert now["n_slips"] == 16
    assert now["T"] == pytest.approx(585.48393, rel=1e-7)
    assert run.lost(now) < 1e-8


CASES = [("lugre", PUBLISHED, 40.0), ("rate_state", QDYN, 3000.0), ("rate_state", {}, 20.0)]


@pytest.mark.parametrize(("law", "given", "length"), CASES)
def test_the_communication_step_does_not_matter(
    law: str, given: dict[str, float], length: float
) -> None:
    chance = random.Random(1)
    cuts = sorted(chance.uniform(0.0, length) for _ in range(300))
    many, one = Run(law, given), Run(law, given)
    for until in [*cuts, length]:
        read = many.advance(until - many.time)
    whole = one.advance(length)
    assert read["n_slips"] > 3
    for name in ("T", "t_stick", "t_slip", "delta_x", "spring_drop", "x_dot_peak", "n_slips"):
        assert read[name] == whole[name], name
    for name in ("z", "x", "W_pull", "Q_friction"):
        assert read[name] == pytest.approx(whole[name], rel=1e-12), name


@pytest.mark.parametrize(("law", "given", "length"), CASES)
def test_a_restored_block_goes_on_with_the_same_bits(
    law: str, given: dict[str, float], length: float
) -> None:
    kept, made = Run(law, given), Run(law, given)
    for _ in range(50):
        made.block.remake()
        assert made.advance(length / 50) == kept.advance(length / 50)


@pytest.mark.parametrize(("law", "given", "length"), CASES)
def test_inputs_and_parameters_change_within_the_motion(
    law: str, given: dict[str, float], length: float
) -> None:
    run = Run(law, given)
    before = run.advance(0.37 * length)
    run.block.set("k", 2.0 * run.values["k"])
    now = run.advance(1e-14 * length)
    assert now["F"] == pytest.approx(2.0 * before["F"], rel=1e-6)
    assert now["W_k"] == pytest.approx(0.5 * run.values["k"] * before["z"] ** 2, rel=1e-6)
    run.block.set("load", run.values["load"] + 0.1 * now["F_s"])
    run.block.set("v", -run.values["v"])
    run.values["k"] *= 2.0
    run.values["z_start"] /= math.sqrt(2.0)
    now = run.advance(2.0 * length)
    assert now["F"] < 0.0
    assert run.lost(now) < 1e-8


def test_a_change_of_the_load_changes_the_state() -> None:
    run = Run("rate_state", QDYN | {"alpha": 0.2})
    before = run.advance(100.0)["theta"]
    run.block.set("load", 0.9 * 5e6 - G)
    after = run.advance(1e-9)["theta"]
    assert after / before == pytest.approx((1.0 / 0.9) ** (0.2 / 0.025), rel=1e-6)


@pytest.mark.parametrize("evolution", [1.0, 2.0])
def test_a_velocity_step_shows_both_effects(evolution: float) -> None:
    # A spring so stiff that the velocity is that of the pull: Dieterich 1979.
    given = {"m": 1e-3, "load": 1e3 - 1e-3 * G, "k": 1e12, "c": 0.0, "v": 1e-6}
    run = Run("rate_state", given | {"evolution": evolution, "theta_start": 10.0})
    steady = run.advance(200.0)["mu"]
    assert steady == pytest.approx(0.6, abs=1e-9)
    run.block.set("v", 1e-5)
    peak = max(run.advance(1e-3)["mu"] for _ in range(2000))
    assert peak == pytest.approx(0.6 + 0.01 * math.log(10.0), abs=2e-4)
    assert run.advance(200.0)["mu"] == pytest.approx(0.6 - 0.005 * math.log(10.0), abs=1e-9)


@pytest.mark.parametrize(
    ("law", "given", "length"),
    [
        *CASES[:2],
        ("rate_state", {"evolution": 2.0, "v": 0.002, "b": 0.0125}, 2.0),
        ("lugre", {"mu_s": 0.4, "delta": 1.0, "v_d": 0.02, "c": 3.0, "v": -0.02}, 2.0),
    ],
)
def test_the_reference_has_the_same_cycles(
    law: str, given: dict[str, float], length: float
) -> None:
    run = Run(law, given)
    now = run.advance(length)
    its = stickslip_ref.friction_law(law)
    shared = {each.name for each in fields(stickslip_ref.Parameters)}
    trajectory = stickslip_ref.simulate(
        stickslip_ref.Parameters(**{n: x for n, x in run.values.items() if n in shared}),
        length,
        law=its,
        own={name: run.values[name] for name in its.parameters},
    )
    assert now["n_slips"] > 2
    for name in ("T", "t_stick", "t_slip", "delta_x", "spring_drop", "x_dot_peak", "t_event"):
        assert now[name] == pytest.approx(getattr(trajectory, name)[-1], rel=1e-8), name
    for name in ("z", "x", "W_pull", "Q_friction"):
        scale = np.abs(getattr(trajectory, name)).max()
        assert abs(now[name] - getattr(trajectory, name)[-1]) < 1e-8 * scale, name


def test_stiff_bristles_are_stribecks_curve() -> None:
    """The period tends to Stribeck's as sigma_0^(-1/2) where sigma_1 = sqrt(sigma_0)."""
    names = ("m", "k", "v", "c", "mu_s", "mu_k", "v_s")
    stribeck = Run("stribeck", {name: PUBLISHED[name] for name in names})
    limit = stribeck.advance(60.0)["T"]
    differences = []
    for sigma_0 in (1e7, 1e9, 1e11):
        own = {"sigma_0": sigma_0, "sigma_1": math.sqrt(sigma_0)}
        differences.append(limit - Run("lugre", PUBLISHED | own).advance(60.0)["T"])
    ratios = [one / other for one, other in pairwise(differences)]
    # Slightly faster, as by a logarithm.
    assert all(10.0 < ratio < 14.0 for ratio in ratios)


def random_values(law: str, chance: random.Random) -> tuple[dict[str, float], float]:
    """Return settings of a block and some of its periods [s]."""

    def between(low: float, high: float) -> float:
        return math.exp(chance.uniform(math.log(low), math.log(high)))

    m, way = between(1e-2, 1e4), chance.choice((1.0, 1.0, -1.0))
    if law == "lugre":
        k, mu_k = m * between(1.0, 1e6), chance.uniform(0.02, 0.8)
        mu_s = mu_k * chance.uniform(1.0, 2.5)
        sigma_0 = k * between(1e1, 3e7)
        length, w = max(mu_s - mu_k, 1e-3 * mu_s) * m * G / k, math.sqrt(k / m)
        v = w * length * between(1e-2, 10.0)
        own = {
            "k": k, "mu_s": mu_s, "mu_k": mu_k, "sigma_0": sigma_0,
            "sigma_1": 2.0 * between(0.05, 5.0) * math.sqrt(sigma_0 * m),
            "c": chance.choice((0.0, 1.0)) * between(1e-3, 0.5) * math.sqrt(k * m),
            "v_s": v * between(1e-2, 1e2), "delta": chance.choice((1.0, 1.5, 2.0)),
            "v_d": chance.choice((0.0, v)), "x_dot_start": chance.choice((0.0, v, -2.0 * v)),
            "v": way * v, "m": m,
        }  # fmt: skip
        return own, 6.0 * (2.0 * length / v + 2.0 * math.pi / w + 0.3 * mu_s * m * G / k / v)
    normal, a = between(1e2, 1e7), between(1e-3, 0.02)
    b, D_c, v = a * chance.uniform(0.7, 1.6), between(1e-6, 1e-3), between(1e-9, 1e-3)
    inertia = chance.choice((1.0, 2.0))
    k = max(abs(b - a), 0.01 * a) * normal / D_c * between(1e-2, 3.0)
    c = between(1e-6, 1.0) * a * normal / v if inertia == 2.0 else 0.1 * math.sqrt(k * m)
    own = {"m": m, "load": normal - m * G, "k": k, "a": a, "b": b, "D_c": D_c, "v": v, "c": c,
           "evolution": chance.choice((1.0, 2.0)), "inertia": inertia,
           "theta_start": D_c / v * between(0.1, 10.0)}  # fmt: skip
    return own, 100.0 * D_c / v + 20.0 * a * normal / k / v


@pytest.mark.parametrize("law", ["lugre", "rate_state"])
def test_no_setting_is_too_stiff(law: str, sized: Sized) -> None:
    chance, cycles = random.Random(3), 0
    count = sized(200)
    for number in range(count):
        own, length = random_values(law, chance)
        run = Run(law, own)
        now = run.advance(length)
        assert run.lost(now) < 1e-7, (number, own)
        cycles += now["n_slips"] > 2
    assert cycles > 0.4 * count


MIRRORED = [
    {"c": 1e3, "z_start": 0.01, "v": 1e-5},
    {"c": 1e6, "theta_start": 1e-20, "z_start": 1e-3, "mu_0": 0.0},  # the damping takes the force
    {"c": 268.0, "k": 1e6, "z_start": 5.6e-4, "v": 0.0, "mu_0": 0.0},  # comes to rest
]


@pytest.mark.parametrize("given", MIRRORED)
def test_without_inertia_a_motion_has_its_mirror(given: dict[str, float]) -> None:
    """The velocity from the balance of forces is the same forward and backward, to the bit."""
    given = {"inertia": 2.0, "v": 0.02} | given
    one = Run("rate_state", given)
    other = Run("rate_state", given | {"z_start": -given["z_start"], "v": -given["v"]})
    now, mirror = one.advance(10.0), other.advance(10.0)
    for name in ("z", "x", "x_dot", "delta_x", "x_dot_peak"):
        assert now[name] == -mirror[name], name
    for name in ("Q_friction", "theta", "t_slip"):
        assert now[name] == mirror[name], name
    assert one.lost(now) < 1e-11


def test_a_velocity_passes_zero_where_friction_is_viscous() -> None:
    """Far below V_0 exp(-mu_0/a) the forces round by more than friction changes."""
    run = Run("rate_state", {"b": 0.0, "mu_0": 0.002, "v": 1e-8, "V_0": 1e-9, "load": 220.0,
                             "k": 2.5e7, "z_start": 0.0, "x_dot_start": 0.0})  # fmt: skip
    run.block.set("F_ext", -40.0)
    now = run.advance(400.0)
    normal = 220.0 + run.values["m"] * G
    friction = 0.01 * math.asinh(5.0 * math.exp(0.2)) * normal + run.values["c"] * 1e-8
    assert now["F"] - 40.0 == pytest.approx(friction, rel=1e-9)


def test_heat_is_as_good_as_the_motion() -> None:
    run = Run("lugre", {"sigma_0": 1e9, "sigma_1": 1e9})
    now = run.advance(10.0)
    assert now["n_slips"] > 9
    assert run.lost(now) < 1e-9


def test_a_mass_that_is_lifted_moves_freely() -> None:
    """Without a normal force nothing holds a mass; bristles that let go push it by sigma_1 zeta."""
    run = Run("lugre", {})
    run.advance(0.05)
    run.block.set("v", 0.0)
    before = run.advance(0.05)
    run.block.set("load", -run.values["m"] * G)
    w = math.sqrt(run.values["k"] / run.values["m"])
    now = run.advance(0.01)
    push = before["x_dot"] + run.values["sigma_1"] * before["zeta"] / run.values["m"]
    free = before["z"] * math.cos(0.01 * w) - push / w * math.sin(0.01 * w)
    assert now["z"] == pytest.approx(free, rel=1e-6)


@pytest.mark.parametrize("law", ["lugre", "rate_state"])
def test_minus_zero_is_zero(law: str) -> None:
    read = []
    for v in (0.0, -0.0):
        run = Run(law, {})
        run.advance(0.7)
        run.block.set("v", v)
        read.append(run.advance(1.0))
    assert read[0] == read[1]


@pytest.mark.parametrize(
    ("law", "given", "error"),
    [
        ("lugre", {"sigma_0": 1e9, "sigma_1": 3e4}, 1e-6),
        *(("rate_state", {"a": a, "b": 0.02, "z_start": 0.0}, 1e-9) for a in (1e-2, 2e-3, 1e-3)),
    ],
)
def test_friction_holds_a_mass_at_rest_until_it_breaks_away(
    law: str, given: dict[str, float], error: float
) -> None:
    """Bristles creep faster and faster: the error allowed is m x_ddot. The creep of rate and state
    spans up to 250 powers of ten, and decides when it slips.
    """
    run = Run(law, given)
    run.advance(0.05)
    for _ in range(3):
        now = run.advance(0.03)
        assert now["F"] == pytest.approx(run.values["k"] * run.values["v"] * run.time, rel=2e-2)
        assert -now["F_friction"] == pytest.approx(now["F"], rel=error)
    now = run.advance(0.4)
    assert now["n_slips"] >= 1
    assert 0.002 < now["spring_drop"] < 0.01


def test_what_doubles_cannot_follow_is_refused_by_its_cause() -> None:
    with pytest.raises(FmuError, match=r"a = 0\.0008 .* mu_0/a = 7\S+ is above 600"):
        ss.simulate(ss.Parameters(law="rate_state", own={"a": 0.0008}), 1.0)


EXTREMES = [
    ("lugre", PUBLISHED | {"sigma_0": 1e12, "sigma_1": 1e6}, 60.0),
    ("lugre", PUBLISHED | {"sigma_0": 1e12, "sigma_1": 0.0}, 0.02),
    ("lugre", PUBLISHED | {"load": -G}, 60.0),
    ("lugre", PUBLISHED | {"v": 0.0, "z_start": 0.5}, 60.0),
    ("rate_state", QDYN | {"a": 0.024975}, 3000.0),
    ("rate_state", QDYN | {"D_c": 1e-9}, 100.0),
    ("rate_state", QDYN | {"v": 0.0}, 3000.0),
]


@pytest.mark.parametrize(("law", "given", "length"), EXTREMES)
def test_extremes_end(law: str, given: dict[str, float], length: float) -> None:
    run = Run(law, given)
    assert run.lost(run.advance(length)) < 1e-7


FAULTS = tomllib.loads(Path(__file__).with_name("whole_faults.toml").read_text())


@pytest.mark.soak
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_detected_by_the_verdict(fault: str, tmp_path: Path) -> None:
    file, sound, planted = FAULTS[fault]
    law = "rate_state" if file == "rate_state.c" else "lugre"
    files = sources_of(2, law)
    text = files[file].decode()
    assert text.count(sound) == 1
    sources = {**files, file: text.replace(sound, planted).encode()}
    files_c = written(sources, tmp_path)
    run("cc", *FLAGS, "-shared", *files_c, "-o", tmp_path / "a.so", "-lm")
    fmu = packer.build(tmp_path / "sound.fmu", law=law, this_machine=True)
    faulty = with_library(fmu, tmp_path / "a.so", tmp_path / "faulty.fmu")
    assert not ss.verify(faulty, sequences=0).passed


@pytest.mark.soak
@pytest.mark.parametrize("law", ["lugre", "rate_state"])
def test_the_verdict_calls_the_model_right(law: str, tmp_path: Path) -> None:
    assert ss.verify(packer.build(tmp_path, law=law, this_machine=True), sequences=0).passed


@pytest.mark.parametrize("law", ["lugre", "rate_state"])
def test_what_the_laws_have_not_is_refused(law: str, tmp_path: Path) -> None:
    assert isinstance(friction_law(law).law, NativeOnly)
    with pytest.raises(ValueError, match=r"has no Python FMU.*\(--native\)$"):
        build(tmp_path, law=law)
    with pytest.raises(ValueError, match=r"is for co-simulation, not for model exchange$"):
        packer.build(tmp_path, law=law, this_machine=True, model_exchange=True)
    rows = core(law).spec.table.by_name
    positive = {"lugre": ("sigma_0", "v_s"), "rate_state": ("a", "D_c", "V_0", "theta_start")}[law]
    for name in positive:
        assert "above 0" in str(rows[name].objection(0.0))


@pytest.mark.parametrize(
    ("own", "says"),
    [
        ({}, r"sigma_1 \(mu_s - mu_k\)/mu_k = 200\.0\d* N\.s/m is above c = 0\.0 .*not passive"),
        ({"v_d": 10.0}, r"N may be above 4 mu_k N = 11\.77\d* N: .*may not be passive"),
        ({"v_d": 0.01}, ""),
    ],
)
def test_a_warning_says_where_friction_may_give_energy(own: dict[str, float], says: str) -> None:
    notes = ss.simulate(ss.Parameters(law="lugre", own=own), 0.01).notes
    assert re.search(says, notes[0]) if says else not notes


@pytest.mark.parametrize(
    ("law", "own", "shown"),
    [
        ("lugre", {"sigma_0": "20 N/mm", "sigma_1": 100.0}, "zeta"),
        ("rate_state", {"mu_0": 0.4, "a": 0.02, "b": 0.03, "D_c": "20 um"}, "mu"),
    ],
)
def test_a_user_sets_all_parameters_and_reads_the_state_by_either_engine(
    law: str, own: dict[str, str | float], shown: str
) -> None:
    p = ss.Parameters(law=law, own=own, c=1.0)
    block, reference = (ss.simulate(p, 0.6, engine=each) for each in ("block", "reference"))
    assert block["n_slips"][-1] == reference["n_slips"][-1] > 0
    for name in ("T", "t_slip", shown):
        assert block[name][-1] == pytest.approx(reference[name][-1], rel=1e-7), name

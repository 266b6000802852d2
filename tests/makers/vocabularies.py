"""Foreign names by the suite's, with units; a sign before one says that it counts the other way."""

OURS = """
m m kg; g g m/s2; k k N/m; c c N.s/m; mu_s mu_s; mu_k mu_k
x_start x_start m; x_dot_start x_dot_start m/s; z_start z_start m
v v m/s; load load N; F_ext F_ext N
x x m; x_dot x_dot m/s; z z m; F F N; sticking sticking
"""

MM = """
m slider.mass kg; g world.g mm/s2; k spring.rate N/mm; c friction.damping N.s/mm
mu_s friction.static 1; mu_k friction.kinetic 1
x_start slider.s0 millimetre; x_dot_start slider.v0 mm/s; z_start -spring.compression0 millimetre
v drive.speed mm/s; load slider.preload kN; F_ext slider.push kN
x slider.s millimetre; x_dot slider.v mm/s; x_pull drive.s millimetre
z -spring.compression millimetre; F spring.force kN; F_friction friction.force N
F_s friction.limit N; sticking stuck; mode phase
delta_x cycle.jump millimetre; spring_drop cycle.relief millimetre; t_stick cycle.stick ms
t_slip cycle.slip ms; T cycle.period ms; f cycle.rate kHz; x_dot_peak cycle.top mm/s
n_slips cycle.count; t_event cycle.instant ms
W_pull energy.drive mJ; W_k energy.tuning mJ; Q_friction energy.heat mJ
mu_k_used friction.kinetic_used 1
"""

SI = """
m mass kilogram; g gravity m/s2; k stiffness N/m; c damping N.s/m
mu_s mu_static; mu_k mu_kinetic
x_start position0 m; x_dot_start speed0 m/s; z_start extension0 m
v pull_speed m/s; load normal_load N; F_ext push N
x slider_position m; x_dot slider_speed m/s; x_pull driven_position m
z extension m; F spring_force N; F_friction friction_force N
F_s break_away_force N; sticking stuck; mode phase
delta_x jump m; spring_drop relief m; t_stick stick_time s
t_slip slip_time s; T period s; f frequency Hz; x_dot_peak top_speed m/s
n_slips slips; t_event last_event s
W_pull work_of_pull J; W_k work_of_tuning J; Q_friction heat J
mu_k_used mu_kinetic_used
"""

PLAIN = """
m mass kg; g gravity m/s2; k stiffness N/m; c damping N.s/m; mu_s cof_static; mu_k cof_kinetic
x_start x0 m; x_dot_start v0 m/s; z_start stretch0 m; v velocity_in m/s; load normal_load N
F_ext push N; x pos m; x_dot vel m/s; z stretch m; F f_spring N; F_friction force N; sticking stuck
"""

TERSE = """
m m; g g; k c; c d; mu_s mus; mu_k muk; v v; F_ext f; load n
x s; x_dot u; x_pull p; z -e; F q; F_friction -r; sticking h
"""

MIRRORED = {"x_start", "x_dot_start", "v", "F_ext", "x", "x_dot", "x_pull", "mode", "delta_x"}
MIRRORED |= {"x_dot_peak"}
"""What changes its sign where the axis points the other way and the spring counts as it did.

Friction, which is the force on the way there, keeps it.
"""

BASES: dict[str, dict[str, float]] = {
    "kg": {"kg": 1},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "s": {"s": 1},
    "Hz": {"s": -1},
    "J": {"kg": 1, "m": 2, "s": -2},
    "K": {"K": 1},
    "1": {},
}
_OTHERS = """
kilogram kg 1; millimetre m 1e-3; mm/s m/s 1e-3; mm/s2 m/s2 1e-3; N/mm N/m 1e3; N.s/mm N.s/m 1e3
kN N 1e3; ms s 1e-3; kHz Hz 1e3; mJ J 1e-3
"""


def entries(text: str) -> list[list[str]]:
    return [entry.split() for entry in text.strip().replace("\n", ";").split(";")]


UNITS: dict[str, dict[str, float]] = {
    **BASES,
    **{unit: {**BASES[si], "factor": float(factor)} for unit, si, factor in entries(_OTHERS)},
}
"""Units of the foreign FMUs: what each is in the base units of FMI."""

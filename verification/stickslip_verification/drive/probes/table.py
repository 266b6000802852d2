"""The probes by the names that invariants use."""

from collections.abc import Callable

from stickslip_verification.drive.probes import (
    calls,
    declarations,
    environments,
    memory,
    refusals,
)

Probe = Callable[..., list[str]]
"""Takes the FMU and the probe's arguments. Raises `FmuError`, or `NotApplicableError`."""

_PROBES: tuple[Probe, ...] = (
    declarations.declared_variables,
    declarations.declared_units,
    declarations.declared_types,
    declarations.declared_starts,
    refusals.refuses,
    refusals.warns,
    refusals.fails_until_reset,
    calls.starts_at,
    calls.same_motion,
    calls.gives,
    calls.steps_onto_restick,
    calls.keeps_its_cycle,
    environments.state_in_a_fresh_process,
    environments.elsewhere,
    memory.keeps_memory,
)

PROBES = {probe.__name__: probe for probe in _PROBES}
"""What an invariant can name as ``probe``."""

OF_NUMERICAL = frozenset({calls.keeps_its_cycle.__name__})
"""The probes of numerical solutions; the exact block meets long cases in their stead."""

LONG = OF_NUMERICAL | {
    name
    for name, probe in PROBES.items()
    if probe.__module__ in (environments.__name__, memory.__name__)
}
"""The probes that take long: a long run, or a process of their own, half a second and more."""

"""Probes of an FMU as a whole: what it declares and refuses, and how it bears a master's calls.

A probe returns its complaints, one line each; none if the FMU is sound.
"""

from collections.abc import Callable

from stickslip_verification.drive.probes.ageing import keeps_its_cycle
from stickslip_verification.drive.probes.calls import (
    gives,
    same_motion,
    starts_at,
    steps_onto_restick,
)
from stickslip_verification.drive.probes.declarations import (
    declared_starts,
    declared_types,
    declared_units,
    declared_variables,
)
from stickslip_verification.drive.probes.environments import elsewhere, state_in_a_fresh_process
from stickslip_verification.drive.probes.memory import (
    memory_of_instances,
    memory_of_states,
    memory_of_steps,
)
from stickslip_verification.drive.probes.refusals import (
    fails_until_reset,
    refuses,
    refuses_step,
    warns,
)

Probe = Callable[..., list[str]]
"""Takes the FMU and the probe's arguments. Raises `FmuError`, or `NotApplicableError`."""

PROBES: dict[str, Probe] = {
    probe.__name__: probe
    for probe in (
        declared_variables,
        declared_units,
        declared_types,
        declared_starts,
        refuses,
        refuses_step,
        warns,
        fails_until_reset,
        starts_at,
        same_motion,
        gives,
        steps_onto_restick,
        keeps_its_cycle,
        state_in_a_fresh_process,
        elsewhere,
        memory_of_steps,
        memory_of_states,
        memory_of_instances,
    )
}
"""What an invariant can name as ``probe``."""

IN_A_FRESH_PROCESS = frozenset(
    probe.__name__
    for probe in (
        state_in_a_fresh_process,
        elsewhere,
        memory_of_steps,
        memory_of_states,
        memory_of_instances,
    )
)
"""The probes that start a process of their own, each half a second and more."""

OF_NUMERICAL = frozenset({keeps_its_cycle.__name__})
"""The probes of numerical solutions; the exact block meets long cases in their stead."""

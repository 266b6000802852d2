"""The probes by the names that invariants use."""

from collections.abc import Callable, Mapping

from stickslip_verification.drive.probes import calls, contract, environments, memory

Probe = Callable[..., list[str]]

_IN_A_FRESH_PROCESS: tuple[Probe, ...] = (
    environments.state_in_a_fresh_process,
    environments.elsewhere,
    memory.keeps_memory,
)

_PROBES: tuple[Probe, ...] = (
    contract.declared_variables,
    contract.declared_units,
    contract.declared_types,
    contract.declared_starts,
    contract.refuses,
    contract.warns,
    contract.fails_until_reset,
    calls.starts_at,
    calls.same_motion,
    calls.gives,
    calls.steps_onto_restick,
    calls.keeps_its_cycle,
    *_IN_A_FRESH_PROCESS,
)

PROBES: Mapping[str, Probe] = {probe.__name__: probe for probe in _PROBES}
"""What an invariant can name as ``probe``: a function of the FMU and of the probe's arguments."""

OF_NUMERICAL = frozenset({calls.keeps_its_cycle.__name__})
"""The probes of numerical solutions; the exact block meets long cases in their stead."""

LONG_PROBES = OF_NUMERICAL | {probe.__name__ for probe in _IN_A_FRESH_PROCESS}
"""The probes that take long: a long run, or a process of their own, half a second and more."""

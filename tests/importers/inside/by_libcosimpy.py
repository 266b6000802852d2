"""libcosim through libcosimpy: a fixed-step execution, inputs by an override manipulator."""

from typing import Any

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from .containing import BLOCKS, LINK, for_block

_REAL, _INTEGER, _BOOLEAN = 0, 1, 3
_OUTPUT = 2
_NANOSECONDS = 1_000_000_000
"""In a second: libcosim counts time in whole ones."""


def run(fmu: str, case: Any) -> Any:
    """Run a case; the case `restart` in a second execution, since libcosim has no reset."""
    [first] = once(fmu, case)
    if case["name"] != "restart":
        return first
    [second] = once(fmu, case)
    return {**first, "again": second, "how": "a second execution and slave"}


def pair(fmu: str, case: Any) -> Any:
    """Run a case of two blocks in one execution, the second pushed by the first one's spring."""
    first, second = once(fmu, case, BLOCKS)
    return {**first, "nested": second}


def once(fmu: str, case: Any, blocks: tuple[str, ...] = ("block",)) -> list[Any]:
    """Run a case in an execution of its own; return the rows of each block."""
    execution = CosimExecution.from_step_size(round(case["step"] * _NANOSECONDS))
    slaves = [CosimLocalSlave(fmu, name) for name in blocks]
    indices = {
        name: execution.add_local_slave(each) for name, each in zip(blocks, slaves, strict=True)
    }
    variables = {
        each.name.decode(): (each.reference, each.type, each.causality)
        for each in execution.slave_variables(indices[blocks[0]])
    }
    if len(blocks) > 1:
        ends = [(indices[block], variables[name][0]) for block, name in LINK]
        execution.connect_real_variables(*ends[0], *ends[1])
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    manipulator = CosimManipulator.create_override()
    execution.add_manipulator(manipulator)
    for block, index in indices.items():
        for name, value in for_block(block, case["start"]).items():
            assert execution.real_initial_value(index, variables[name][0], value), name
    rows: dict[str, Any] = {block: {"times": [], "outputs": {}} for block in blocks}
    for number in range(case["steps"]):
        for block, index in indices.items():
            changes = for_block(block, case["changes"].get(str(number), {}))
            references = [variables[name][0] for name in changes]
            assert not changes or manipulator.slave_real_values(
                index, references, list(changes.values())
            )
        assert execution.step(), f"step {number} failed"
        for block, index in indices.items():
            rows[block]["times"].append(execution.status().current_time / _NANOSECONDS)
            for name, value in _observed(observer, index, variables):
                rows[block]["outputs"].setdefault(name, []).append(value)
    return list(rows.values())


def _observed(observer: Any, index: int, variables: Any) -> list[tuple[str, Any]]:
    """Return what was last observed of every output of a block."""
    found: list[tuple[str, Any]] = []
    for kind, read in (
        (_REAL, observer.last_real_values),
        (_INTEGER, observer.last_integer_values),
        (_BOOLEAN, observer.last_boolean_values),
    ):
        names = [n for n, (_, k, c) in variables.items() if k == kind and c == _OUTPUT]
        values = read(index, [variables[name][0] for name in names])
        found += zip(names, values, strict=True)
    return found

"""Two blocks together: the second pushed by the spring force of the first."""

from typing import Any

BLOCKS = ("a", "b")
LINK = (("a", "F"), ("b", "F_ext"))


def both(case: Any) -> Any:
    """Return the case for the container's variables: what is set in `a` is set in `b` too."""
    return {
        **case,
        "start": _for_both(case["start"]),
        "changes": {number: _for_both(changes) for number, changes in case["changes"].items()},
    }


def _for_both(values: Any) -> Any:
    return {
        f"{block}.{name}": value
        for block in BLOCKS
        for name, value in for_block(block, values).items()
    }


def for_block(block: str, values: Any) -> Any:
    """Return what of these values is set in a block: not what comes from the other one."""
    return {name: value for name, value in values.items() if (block, name) != LINK[1]}


def of_both(names: list[str]) -> list[str]:
    """Return the names of a variable of each block as the container has them."""
    return [f"{block}.{name}" for block in BLOCKS for name in names]


def split(rows: Any, names: list[str]) -> Any:
    """Return the rows of a container as those of block a, with those of block b nested."""

    def one(block: str, of: Any) -> Any:
        return {
            "times": of["times"],
            "outputs": {name: of["outputs"][f"{block}.{name}"] for name in names},
        }

    both = {**one("a", rows), "nested": one("b", rows)}
    if "again" in rows:
        again = rows["again"]
        both["again"] = {**one("a", again), "nested": one("b", again)}
        both["how"] = f"{rows['how']}, the container"
    return both

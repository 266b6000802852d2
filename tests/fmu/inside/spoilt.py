"""Serialized states that were spoilt on their way."""

import contextlib
import io
import json
from typing import Any

from tests.fmu.importer import Importer

# Numbers that no state can have, each of the right type.
_IMPOSSIBLE: tuple[tuple[tuple[Any, ...], float], ...] = (
    (("model", "elapsed"), -1.0),
    (("model", "elapsed_low"), -5.0),
    (("model", "x", 1), 1.0),
    (("model", "meter", "_phase", 1), 0.5),
    (("model", "meter", "t_slip"), -1.0),
    (("model", "meter", "t_stick"), -1.0),
    (("model", "meter", "T"), -1.0),
    (("model", "meter", "n_slips"), -1),
    (("model", "Q_friction", 0), -1.0),
    (("model", "arc", 0), 2),
    (("model", "arc", 4), -1.0),
)


def tried(importer: Importer, _: Any) -> Any:
    """Spoil a good state in every place and restore it.

    Returns
    -------
    Any
        How many were tried, how many refused, and how many of these by an error that was not meant.
    """
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        tried, refused = _counted(importer)
    return tried, refused, said.getvalue().count("internal error")


def _counted(importer: Importer) -> tuple[int, int]:
    slave = importer.instance(c=0.5)
    for index in range(30):
        slave.doStep(0.02 * index, 0.02)
    good = json.loads(slave.serializeFMUstate(slave.getFMUstate()))
    slave.freeInstance()
    refused = tried = 0
    for path in _leaves(good):
        bad: Any
        for bad in (None, "x", float("nan"), float("inf"), -1e400, [], {}, True, 10**400):
            state = json.loads(json.dumps(good))
            place = state
            for key in path[:-1]:
                place = place[key]
            if path[-2:] == ["arc", 3] and bad is None:
                continue
            if isinstance(place[path[-1]], type(bad)) and isinstance(bad, (bool, str)):
                continue
            place[path[-1]] = bad
            tried += 1
            refused += _refuses(importer, json.dumps(state).encode())
    for path, bad in _IMPOSSIBLE:
        state = json.loads(json.dumps(good))
        place = state
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = bad
        tried += 1
        refused += _refuses(importer, json.dumps(state).encode())
    for garbage in (b"", b"{", b"[]", b"null", b"[" * 100_000, b'{"block": 1}', b"\xff"):
        tried += 1
        refused += _refuses(importer, garbage)
    return tried, refused


def _refuses(importer: Importer, state: bytes) -> bool:
    """Whether an instance refuses a serialized state, and lives on after a reset."""
    slave = importer.instance()
    refused = importer.fails(slave.setFMUstate, slave.deSerializeFMUstate(state))
    slave.reset()
    importer.start(slave)
    slave.doStep(0.0, 0.1)
    slave.freeInstance()
    return refused


def _leaves(tree: Any, path: tuple[Any, ...] = ()) -> Any:
    """Give the path of every number, text and truth value in a state."""
    if isinstance(tree, (dict, list)):
        items = tree.items() if isinstance(tree, dict) else enumerate(tree)
        for key, value in items:
            yield from _leaves(value, (*path, key))
    else:
        yield list(path)

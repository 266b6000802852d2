"""An axis with a measure: its numbers by the keys of the axis file, and what a move makes of them.

Numbers are SI, forces and positions at the slide.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from ..axis import Axis
from ..axis.keys import KEYS
from .catalogue import OF_VERDICT, Condition, Measure, Move, Value

_FORCES: Final = ("friction.F_s", "friction.F_k")


def number_of(axis: Axis, key: str) -> Any:
    """Return what an axis has for a key: number, text or tuple; None where it has none."""
    section, _, name = key.partition(".")
    friction = axis.friction
    special = {
        "axis.zeta": axis.c / (2.0 * math.sqrt(axis.k * axis.m)),
        "friction.F_s": axis.F_s,
        "friction.F_k": axis.F_k,
        "drive.kind": axis.kind,
        "drive.position": axis.drive and ("table" if axis.drive.on_table else "motor"),
    }
    if key in special:
        return special[key]
    if section == "friction" and name in friction.own:
        return friction.own[name]
    part = axis if section == "axis" else getattr(axis, section)
    return getattr(part, KEYS[key].symbol or name, None)


def with_number(axis: Axis, key: str, value: Any) -> Axis:
    """Return an axis with another number for a key that it has; what else it states is held.

    Forces of the friction are held where they were stated, and else the coefficients.
    """
    section, _, name = key.partition(".")
    friction, symbol = axis.friction, KEYS[key].symbol
    if key == "axis.zeta":
        return replace(axis, c=2.0 * value * math.sqrt(axis.k * axis.m))
    if section == "axis":
        changed = replace(axis, **{symbol: value})
        less = axis.normal_force / changed.normal_force if friction.in_newtons else 1.0
        held = replace(friction, mu_s=friction.mu_s * less, mu_k=friction.mu_k * less)
        return replace(changed, friction=held)
    if section == "friction":
        if name in ("F_s", "F_k"):
            changes = {f"mu_{name[-1]}": value / axis.normal_force}
        elif name == "law":
            changes = {"law": value, "own": {}, "in_newtons": False}
        elif symbol:
            changes = {symbol: value}
        else:
            changes = {"own": {**friction.own, name: value}}
        return replace(axis, friction=replace(friction, **changes))
    if key == "demand.feeds":
        feeds = tuple(max(feed, value) for feed in axis.demand.feeds)
        return replace(axis, demand=replace(axis.demand, feeds=feeds))
    assert axis.drive is not None
    changes = {"on_table": value == "table"} if key == "drive.position" else {symbol: value}
    return replace(axis, drive=replace(axis.drive, **changes))


def applies(measure: Measure, axis: Axis) -> bool:
    """Return whether the conditions of a measure hold."""
    return all(_holds(condition, axis) for condition in measure.when)


def _holds(condition: Condition, axis: Axis) -> bool:
    now = number_of(axis, condition.key)
    # Forces of the friction are what was stated, or computed of the coefficients.
    if condition.key in _FORCES and not axis.friction.in_newtons:
        return False
    if condition.none_of:
        return now not in condition.none_of
    if now is None or condition.text:
        return now is not None and now == condition.text
    low = -math.inf if condition.above is None else condition.above
    return bool(low < now < (math.inf if condition.below is None else condition.below))


def with_measure(
    axis: Axis, measure: Measure, step: int, verdict: Mapping[str, float]
) -> Axis | None:
    """Return an axis with a step of a measure; None where it changes nothing, or cannot be.

    `verdict` has the numbers of the verdict on the axis as it is, by name.
    """
    changed = axis
    for move in measure.moves:
        value = _moved(changed, move, move.values[min(step, len(move.values) - 1)], verdict)
        if value is None:
            continue
        most = number_of(axis, move.most) if move.most else None
        if most is not None and value > most:
            return None
        # The static friction of a measured curve is bound to its points.
        if changed.friction.is_curve and move.key.startswith("friction.") and "law" not in move.key:
            return None
        changed = with_number(changed, move.key, value)
    friction = changed.friction
    if changed == axis or changed.normal_force <= 0.0 or friction.mu_k > friction.mu_s:
        return None
    return changed


def _moved(axis: Axis, move: Move, value: Value, verdict: Mapping[str, float]) -> Any:
    now = number_of(axis, move.key)
    if now is None or isinstance(value, str):
        return None if now is None else value
    if move.how != "set":
        return now * value if move.how == "scale" else now + value
    if not move.of:
        return value
    whole = verdict.get(move.of) if move.of in OF_VERDICT else number_of(axis, move.of)
    return None if whole is None or not 0.0 < whole < math.inf else whole * value

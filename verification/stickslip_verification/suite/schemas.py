"""JSON schemas of the suite's data files, made from the tables of parameters and choices.

`docs/generate.py` writes them to `docs/schemas/`, where editors find them.
"""

import copy
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from typing import Any

from stickslip_verification.model.verdict import Kind, Klass, Measure
from stickslip_verification.truth.parameters import CHANGEABLE, PARAMETERS, Parameter, changeable

Schema = Mapping[str, Any]


def _text(description: str = "", pattern: str = r"\S") -> dict[str, Any]:
    return _told({"type": "string", "pattern": pattern}, description)


def _number(description: str = "", **bounds: float) -> dict[str, Any]:
    return _told({"type": "number", **bounds}, description)


def _whole(minimum: int, description: str = "") -> dict[str, Any]:
    return _told({"type": "integer", "minimum": minimum}, description)


def _one_of(choices: Iterable[str], description: str = "") -> dict[str, Any]:
    return _told({"enum": [str(choice) for choice in choices]}, description)


def _list(items: Schema, description: str = "", **more: Any) -> dict[str, Any]:
    return _told({"type": "array", "items": items, **more}, description)


def _table(
    needed: Schema, others: Schema | None = None, description: str = "", **more: Any
) -> dict[str, Any]:
    """Return the schema of a table with these keys and no other."""
    table = {"type": "object", "additionalProperties": False, **more}
    if needed:
        table["required"] = list(needed)
    return _told({**table, "properties": {**needed, **(others or {})}}, description)


def _told(schema: dict[str, Any], description: str) -> dict[str, Any]:
    return {"description": description, **schema} if description else schema


def _file(title: str, table: Schema) -> Schema:
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **table}


def _value(parameter: Parameter) -> dict[str, Any]:
    if parameter.low is None:
        return _number(f"[{parameter.unit}]")
    bound = "exclusiveMinimum" if parameter.strict else "minimum"
    return _number(f"[{parameter.unit}]", **{bound: parameter.low})


_ID = _text(pattern=r"^[A-Za-z0-9]+([_.-][A-Za-z0-9]+)*$")
_TEXT = _text()
_AMOUNT = _number(minimum=0)
_SECONDS = _number("[s]", exclusiveMinimum=0)
_SIDES = ("fmu", "reference")
_VALUES = {each.name: _value(each) for each in PARAMETERS}

_AT = {
    "oneOf": [
        _one_of(("end", "every_point")),
        _table(
            {"cycle": _whole(1)},
            description="the first communication point in the stick that follows slip number "
            "`cycle`",
        ),
        _table(
            {"event": _whole(1)},
            description="the first communication point after transition number `event`, counted "
            "from 1",
        ),
    ]
}

_CHECK = _table(
    {"id": _ID, "quantity": _TEXT, "at": _AT},
    {
        "formula": _text("a named closed form; absent: the exact motion at 50 digits"),
        "tolerance": _table(
            {},
            {"measure": _one_of(Measure), **dict.fromkeys(_SIDES, _AMOUNT)},
            "what the rules do not give, or give otherwise",
            minProperties=1,
        ),
        "because": _table(
            {},
            dict.fromkeys(_SIDES, _TEXT),
            "the reason of each side's own tolerance",
            minProperties=1,
        ),
    },
)

CASE: Schema = _file(
    "A verification case of the stick-slip block",
    _table(
        {
            "id": _ID,
            "title": _TEXT,
            "about": _TEXT,
            "experiment": _table(
                {
                    "stop_time": _SECONDS,
                    "steps": {
                        "oneOf": [
                            _table({"fixed": _SECONDS}),
                            _table({"seed": _whole(0), "shortest": _SECONDS, "longest": _SECONDS}),
                            _table({"list": _list(_number(exclusiveMinimum=0), "[s]", minItems=1)}),
                        ]
                    },
                },
                {
                    "changes": _list(
                        _table(
                            {
                                "time": _SECONDS,
                                "set": _table(
                                    {},
                                    {n: v for n, v in _VALUES.items() if n in CHANGEABLE},
                                    minProperties=1,
                                ),
                            }
                        )
                    )
                },
            ),
        },
        {
            "law": _text("the friction law by its name, module:NAME; absent: Coulomb's"),
            "class": _one_of(
                Klass, "contract where the result is a convention and not physics; else physics"
            ),
            "parameters": _table(
                {},
                _VALUES,
                "Values set before the start; what is absent keeps the default of the side.",
            ),
            "courses": _list(
                _TEXT,
                "Outputs, or groups of them, held against the exact motion at every communication "
                "point; all groups if absent.",
            ),
            "courses_at": _one_of(("every_point", "end"), "end: the last communication point only"),
            "cycle": _table(
                {"at": _AT},
                {
                    "only": _list(
                        _TEXT, "which of them; all if absent", minItems=1, uniqueItems=True
                    )
                },
                "The outputs of the steady cycle, held against their closed forms.",
            ),
            "motion": _table(
                {"slips": _whole(0, "completed slips; one under way at the end may count")},
                {
                    "reversals": _whole(0, "slips that turn into a slip the other way"),
                    "zero": _list(
                        _TEXT,
                        "courses that are zero at every communication point",
                        uniqueItems=True,
                    ),
                },
                "What the rules of the tolerances need to know of the exact motion; followed at "
                "each loading if absent.",
            ),
            "tolerances": _table(
                {},
                {
                    "conditioning": _number("below that of the narrowest gap", minimum=1),
                    "fmu": _number("of the exact block's courses, of scale", minimum=0),
                    "because": _text("the reason of fmu; needed where it is looser than the rules"),
                },
                "What the case is held to instead of the rules.",
                minProperties=1,
                dependentRequired={"because": ["fmu"]},
            ),
            "checks": _list(_CHECK),
        },
    ),
)


def case(own: Sequence[Parameter]) -> Schema:
    """Return the schema of a case whose friction law has these parameters of its own."""
    if not own:
        return CASE
    extended: dict[str, Any] = copy.deepcopy(dict(CASE))
    parts = extended["properties"]
    changes = parts["experiment"]["properties"]["changes"]["items"]["properties"]
    parts["parameters"]["properties"] |= {each.name: _value(each) for each in own}
    changes["set"]["properties"] |= {
        each.name: _value(each) for each in own if each.name in changeable(own)
    }
    return extended


_EQUATION = _whole(1, "number in docs/theory.md")
_NAME = _text(pattern="^[a-z_]+$")
_MEANING = {"means": _TEXT, "look": _TEXT}
_LAWS = {
    "laws": _list(_TEXT, "names of the friction laws that it holds for; absent: all", minItems=1)
}


def _by(names: Iterable[str], schema: Schema, description: str = "") -> dict[str, Any]:
    return _table(dict.fromkeys(names, schema), description=description)


def _kinds(*kinds: StrEnum) -> dict[str, Any]:
    return _one_of(kinds) if len(kinds) > 1 else {"const": str(kinds[0])}


_ENTRY = {"id": _ID, "title": _TEXT}
_JUDGED = {**_ENTRY, "class": _one_of(Klass), "source": _EQUATION, **_MEANING}

INVARIANTS: Schema = _file(
    "Invariants that every run of the stick-slip block is held to",
    _table(
        {},
        {
            "residuals": _list(
                _table(
                    {
                        **_JUDGED,
                        "kind": _kinds(Kind.CLOSED_FORM, Kind.INVARIANT),
                        "metric": _text(pattern=r"^[a-z]+\.[a-z_]+$"),
                        "quantity": _TEXT,
                        "tolerance": _by(
                            _SIDES,
                            _AMOUNT,
                            "of the scale that the metric names: of the exact block, and of a "
                            "numerical solution",
                        ),
                        "because": _by(_SIDES, _TEXT),
                    },
                    _LAWS,
                ),
                "residuals in the samples of a case, on each side",
            ),
            "runs": _list(
                _table(
                    {**_JUDGED, "kind": _kinds(Kind.INVARIANT), "run": _NAME, "because": _TEXT},
                    {
                        **_LAWS,
                        "tolerance": _by(
                            ("fmu", "numerical"),
                            _AMOUNT,
                            "of each output's largest value, of the exact block and of a numerical "
                            "solution; absent: bit for bit",
                        ),
                    },
                ),
                "another run of the same FMU that must give the same motion",
            ),
            "probes": _list(
                _table(
                    {**_ENTRY, "probe": _NAME, **_MEANING},
                    {"arguments": {"type": "object"}, **_LAWS},
                ),
                "a question to the FMU as a whole, not to a motion",
            ),
            "agreements": _list(
                _table({**_ENTRY, "quantity": _TEXT}, _LAWS),
                "the FMU against the reference, within the sum of what the case allows each",
            ),
            "orders": _list(
                _table(
                    {
                        **_ENTRY,
                        "source": _EQUATION,
                        "quantity": _TEXT,
                        "cases": _list(_ID, minItems=1, uniqueItems=True),
                        "order": _number(exclusiveMinimum=0),
                        "coarsest": _number("tolerance of a step", exclusiveMinimum=0),
                        "finest": _number("tolerance of a step", exclusiveMinimum=0),
                        "levels": _whole(5),
                        "tolerance": _number("on the slope through all levels", minimum=0),
                        "halves": _number(
                            "on the difference of the slopes of the coarser and the finer half",
                            minimum=0,
                        ),
                        "because": _by(("order", "halves"), _TEXT),
                        **_MEANING,
                    },
                    _LAWS,
                ),
                "the order in which the reference converges as its tolerance falls",
            ),
        },
        minProperties=1,
    ),
)

_PART = "[a-z_][a-z0-9_]*"
_MODULE = rf"{_PART}(/{_PART})*\.py"

FAULT: Schema = _file(
    "A fault to plant in the stick-slip FMU",
    _table(
        {
            "id": _text(
                "The name of the file, without its ending.", pattern="^[a-z0-9]+(-[a-z0-9]+)*$"
            ),
            "about": _text("The fault in the world's words, and where people make it."),
            "detected_by": _list(
                _text(pattern="^[A-Za-z0-9_]+(-[A-Za-z0-9_]+)*$"),
                "Ids of the checks that fit the fault, named in advance; one of them must fail.",
                minItems=1,
                uniqueItems=True,
            ),
        },
        {
            "overrides": _list(
                _table(
                    {
                        "target": _text(
                            "module.name or module.Class.name of the packed source, the module by "
                            "the end of its dotted name; master.get, .set, .step, .reset.",
                            pattern=rf"^{_PART}(\.{_PART})*(\._?[A-Z][A-Za-z0-9_]*)?"
                            r"(\.[A-Za-z_][A-Za-z0-9_]*)$",
                        )
                    },
                    {
                        "code": _text(
                            "Python 3.8 that defines the last name of the target; `original` is "
                            "what it replaces."
                        ),
                        "value": _text(
                            "In place of code: a Python expression, in which `original` is the "
                            "value replaced."
                        ),
                    },
                ),
                "Made in this order, last: what a name stands for is replaced.",
                minItems=1,
            ),
            "substitutions": _list(
                _table(
                    {
                        "file": _text(
                            "A module of the packed source, by the end of its path, or the model "
                            "description.",
                            pattern=rf"^({_MODULE}|modelDescription\.xml)$",
                        ),
                        "find": _TEXT,
                        "replace": {"type": "string"},
                    }
                ),
                "For what no override can say. Made in this order, after the additions; each must "
                "match exactly once.",
                minItems=1,
            ),
            "additions": _list(
                _table(
                    {"file": _text(pattern=f"^{_MODULE}$")},
                    {
                        "text": _TEXT,
                        "source": _text(
                            "A file beside the descriptions that holds the text, where several "
                            "faults share it.",
                            pattern=rf"^{_PART}\.py\.txt$",
                        ),
                    },
                    oneOf=[{"required": ["text"]}, {"required": ["source"]}],
                ),
                "Modules that the fault brings along; Python 3.8, standard library.",
                minItems=1,
            ),
        },
    ),
)

FILES: Mapping[str, Schema] = {
    "case.schema.json": CASE,
    "fault.schema.json": FAULT,
    "invariants.schema.json": INVARIANTS,
}
"""The schemas by the name of the file that documents them."""

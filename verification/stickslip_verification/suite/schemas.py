"""JSON schemas of the suite's data files, made from the tables of parameters and choices.

`docs/generate.py` writes them to `docs/schemas/`, where editors find them.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from stickslip_verification.model.verdict import Kind, Klass, Measure
from stickslip_verification.truth.coulomb import COULOMB
from stickslip_verification.truth.parameters import CHANGEABLE, PARAMETERS, Parameter, changeable

Schema = Mapping[str, Any]


def _told(description: str, schema: Schema) -> Schema:
    return {"description": description, **schema} if description else schema


def _text(description: str = "", pattern: str = r"\S") -> Schema:
    return _told(description, {"type": "string", "pattern": pattern})


def _number(description: str = "", **bounds: float) -> Schema:
    return _told(description, {"type": "number", **bounds})


def _whole(minimum: int, description: str = "") -> Schema:
    return _told(description, {"type": "integer", "minimum": minimum})


def _one_of(choices: Iterable[str], description: str = "") -> Schema:
    return _told(description, {"enum": [str(choice) for choice in choices]})


def _list(items: Schema, description: str = "", **more: Any) -> Schema:
    return _told(description, {"type": "array", "items": items, **more})


def _table(keys: Schema, description: str = "", **more: Any) -> Schema:
    """Return the schema of a table with these keys and no other; ``key?`` may be absent."""
    needed = {key: schema for key, schema in keys.items() if not key.endswith("?")}
    others = {key[:-1]: schema for key, schema in keys.items() if key.endswith("?")}
    required = {"required": list(needed)} if needed else {}
    rules = {"type": "object", "additionalProperties": False, **more, **required}
    return _told(description, {**rules, "properties": {**needed, **others}})


def _some(keys: Schema, description: str = "", **more: Any) -> Schema:
    """Return the schema of a table with at least one of these keys and no other."""
    optional = {f"{key}?": schema for key, schema in keys.items()}
    return _table(optional, description, minProperties=1, **more)


def _file(title: str, table: Schema) -> Schema:
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **table}


def _value(parameter: Parameter) -> Schema:
    bound = "exclusiveMinimum" if parameter.strict else "minimum"
    bounds = {} if parameter.low is None else {bound: parameter.low}
    return _number(f"[{parameter.unit}]", **bounds)


_ID = _text(pattern=r"^[A-Za-z0-9]+([_.-][A-Za-z0-9]+)*$")
_TEXT = _text()
_AMOUNT = _number(minimum=0)
_SECONDS = _number("[s]", exclusiveMinimum=0)
_SIDES = ("fmu", "reference")

_AFTER_CYCLE = "the first communication point in the stick that follows slip number `cycle`"
_AFTER_EVENT = "the first communication point after transition number `event`, counted from 1"
_AT = {
    "oneOf": [
        _one_of(("end", "every_point")),
        _table({"cycle": _whole(1)}, _AFTER_CYCLE),
        _table({"event": _whole(1)}, _AFTER_EVENT),
    ]
}
_STEPS = {
    "oneOf": [
        _table({"fixed": _SECONDS}),
        _table({"seed": _whole(0), "shortest": _SECONDS, "longest": _SECONDS}),
        _table({"list": _list(_number(exclusiveMinimum=0), "[s]", minItems=1)}),
    ]
}
_TOLERANCE = {"measure": _one_of(Measure), **dict.fromkeys(_SIDES, _AMOUNT)}
_CHECK = {
    "id": _ID,
    "quantity": _TEXT,
    "at": _AT,
    "formula?": _text("a named closed form; absent: the exact motion at 50 digits"),
    "tolerance?": _some(_TOLERANCE, "what the rules do not give, or give otherwise"),
    "because?": _some(dict.fromkeys(_SIDES, _TEXT), "the reason of each side's own tolerance"),
}
_ONLY = _list(_TEXT, "which of them; all if absent", minItems=1, uniqueItems=True)
_ZERO = _list(_TEXT, "courses that are zero at every communication point", uniqueItems=True)
_MOTION = {
    "slips": _whole(0, "completed slips; one under way at the end may count"),
    "reversals?": _whole(0, "slips that turn into a slip the other way"),
    "zero?": _ZERO,
}
_CASE_TOLERANCES = {
    "conditioning": _number("below that of the narrowest gap", minimum=1),
    "fmu": _number("of the exact block's courses, of scale", minimum=0),
    "because": _text("the reason of fmu; needed where it is looser than the rules"),
}


def case(own: Sequence[Parameter]) -> Schema:
    """Return the schema of a case whose friction law has these parameters of its own."""
    values = {each.name: _value(each) for each in (*PARAMETERS, *own)}
    moving = CHANGEABLE | changeable(own)
    change = {"time": _SECONDS, "set": _some({n: v for n, v in values.items() if n in moving})}
    experiment = {"stop_time": _SECONDS, "steps": _STEPS, "changes?": _list(_table(change))}
    keys = {
        "id": _ID,
        "title": _TEXT,
        "about": _TEXT,
        "experiment": _table(experiment),
        "law?": _text("the friction law by its name, module:NAME; absent: Coulomb's"),
        "class?": _one_of(
            Klass, "contract where the result is a convention and not physics; else physics"
        ),
        "parameters?": _table(
            {f"{name}?": value for name, value in values.items()},
            "Values set before the start; what is absent keeps the default of the side.",
        ),
        "courses?": _list(
            _TEXT,
            "Outputs, or groups of them, held against the exact motion at every communication "
            "point; all groups if absent.",
        ),
        "courses_at?": _one_of(("every_point", "end"), "end: the last communication point only"),
        "cycle?": _table(
            {"at": _AT, "only?": _ONLY},
            "The outputs of the steady cycle, held against their closed forms.",
        ),
        "motion?": _table(
            _MOTION,
            "What the rules of the tolerances need to know of the exact motion; followed at "
            "each loading if absent.",
        ),
        "tolerances?": _some(
            _CASE_TOLERANCES,
            "What the case is held to instead of the rules.",
            dependentRequired={"because": ["fmu"]},
        ),
        "checks?": _list(_table(_CHECK)),
    }
    return _file("A verification case of the stick-slip block", _table(keys))


def _by(names: Iterable[str], schema: Schema, description: str = "") -> Schema:
    return _table(dict.fromkeys(names, schema), description)


_EQUATION = _whole(1, "number in docs/theory.md")
_NAME = _text(pattern="^[a-z_]+$")
_ENTRY = {"id": _ID, "title": _TEXT}
_MEANING = {"means": _TEXT, "look": _TEXT}
_JUDGED = {**_ENTRY, "class": _one_of(Klass), "source": _EQUATION, **_MEANING}
_LAWS = {
    "laws?": _list(_TEXT, "names of the friction laws that it holds for; absent: all", minItems=1)
}
_RESIDUAL = {
    **_JUDGED,
    "kind": _one_of((Kind.CLOSED_FORM, Kind.INVARIANT)),
    "metric": _text(pattern=r"^[a-z]+\.[a-z_]+$"),
    "quantity": _TEXT,
    "tolerance": _by(
        _SIDES,
        _AMOUNT,
        "of the scale that the metric names: of the exact block, and of a numerical solution",
    ),
    "because": _by(_SIDES, _TEXT),
}
_RUN = {
    **_JUDGED,
    "kind": {"const": str(Kind.INVARIANT)},
    "run": _NAME,
    "because": _TEXT,
    **_LAWS,
    "tolerance?": _number(
        "of the exact block, as a part of each output's largest value; absent: bit for bit",
        minimum=0,
    ),
}
_HALVES = "on the difference of the slopes of the coarser and the finer half"
_ORDER = {
    **_ENTRY,
    "source": _EQUATION,
    "quantity": _TEXT,
    "cases": _list(_ID, minItems=1, uniqueItems=True),
    "order": _number(exclusiveMinimum=0),
    "coarsest": _number("tolerance of a step", exclusiveMinimum=0),
    "finest": _number("tolerance of a step", exclusiveMinimum=0),
    "levels": _whole(5),
    "tolerance": _number("on the slope through all levels", minimum=0),
    "halves": _number(_HALVES, minimum=0),
    "because": _by(("order", "halves"), _TEXT),
    **_MEANING,
}
_PROBE = {
    **_ENTRY,
    "class?": _one_of(Klass),
    "source?": _EQUATION,
    "probe": _NAME,
    **_MEANING,
    "arguments?": {"type": "object"},
}
_SEQUENCES = {**_JUDGED, "kind": _one_of((Kind.CLOSED_FORM, Kind.INVARIANT)), "manner": _NAME}
_FAMILIES = {
    "residuals": (_RESIDUAL, "residuals in the samples of a case, on each side"),
    "runs": (_RUN, "another run of the same FMU that must give the same motion"),
    "sequences": (_SEQUENCES, "random sequences, run in a manner of calling the FMU"),
    "probes": (_PROBE, "a question to the FMU as a whole, not to a motion"),
    "agreements": (
        {**_ENTRY, "quantity": _TEXT},
        "the FMU against the reference, within the sum of what the case allows each",
    ),
    "orders": (_ORDER, "the order in which the reference converges as its tolerance falls"),
}

INVARIANTS = _file(
    "Invariants that every run of the stick-slip block is held to",
    _some(
        {
            family: _list(_table({**keys, **_LAWS}), description)
            for family, (keys, description) in _FAMILIES.items()
        }
    ),
)

_PART = "[a-z_][a-z0-9_]*"
_MODULE = rf"{_PART}(/{_PART})*\.py"
_OVERRIDE = {
    "target": _text(
        "module.name or module.Class.name of the packed source, the module by the end of its "
        "dotted name; master.get, .set, .step, .reset.",
        rf"^{_PART}(\.{_PART})*(\._?[A-Z][A-Za-z0-9_]*)?(\.[A-Za-z_][A-Za-z0-9_]*)$",
    ),
    "code?": _text(
        "Python 3.8 that defines the last name of the target; `original` is what it replaces."
    ),
    "value?": _text(
        "In place of code: a Python expression, in which `original` is the value replaced."
    ),
}
_SUBSTITUTION = {
    "file": _text(
        "A module of the packed source, by the end of its path, or the model description.",
        rf"^({_MODULE}|modelDescription\.xml)$",
    ),
    "find": _TEXT,
    "replace": {"type": "string"},
}
_ADDITION = {
    "file": _text(pattern=f"^{_MODULE}$"),
    "text?": _TEXT,
    "source?": _text(
        "A file beside the descriptions that holds the text, where several faults share it.",
        rf"^{_PART}\.py\.txt$",
    ),
}
_EITHER = [{"required": ["text"]}, {"required": ["source"]}]

FAULT = _file(
    "A fault to plant in the stick-slip FMU",
    _table(
        {
            "id": _text("The name of the file, without its ending.", "^[a-z0-9]+(-[a-z0-9]+)*$"),
            "about": _text("The fault in the world's words, and where people make it."),
            "law?": _text("the friction law whose FMU it is planted in; absent: Coulomb's"),
            "detected_by": _list(
                _text(pattern="^[A-Za-z0-9_]+(-[A-Za-z0-9_]+)*$"),
                "Ids of the checks that fit the fault, named in advance; one of them must fail.",
                minItems=1,
                uniqueItems=True,
            ),
            "overrides?": _list(
                _table(_OVERRIDE),
                "Made in this order, last: what a name stands for is replaced.",
                minItems=1,
            ),
            "substitutions?": _list(
                _table(_SUBSTITUTION),
                "For what no override can say. Made in this order, after the additions; each must "
                "match exactly once.",
                minItems=1,
            ),
            "additions?": _list(
                _table(_ADDITION, oneOf=_EITHER),
                "Modules that the fault brings along; Python 3.8, standard library.",
                minItems=1,
            ),
        }
    ),
)

FILES: Mapping[str, Schema] = {
    "case.schema.json": case(COULOMB.parameters),
    "fault.schema.json": FAULT,
    "invariants.schema.json": INVARIANTS,
}
"""The schemas by the name of the file that documents them."""

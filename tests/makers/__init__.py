"""One maker of FMUs that are not ours: other names and units, another method, faults, misdeeds."""

from __future__ import annotations

import hashlib
import re
import subprocess
import zipfile
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple
from xml.sax.saxutils import quoteattr

import fmpy
from pythonfmu.builder import FmuBuilder
from pythonfmu3.builder import FmuBuilder as FmuBuilder3

from stickslip_verification import NameMap
from stickslip_verification.drive import FmuFile
from stickslip_verification.drive.description import Target
from tests.makers import vocabularies
from tests.sharing import made_once

HERE = Path(__file__).parent
DESCRIPTION = "modelDescription.xml"

FIXED = ("m", "g", "x_start", "x_dot_start", "z_start")
TUNABLE = ("k", "c", "mu_s", "mu_k")
INPUTS = ("v", "load", "F_ext")

Row = tuple[str, str, int, str, str]
"""Foreign name, unit, sign, causality, variability."""


@dataclass(frozen=True)
class Foreign:
    """A foreign FMU, made when its path is first asked for.

    `vocabulary` is ours, mm, si or mirrored: mm with the axis turned round. `keys` are the
    variables that it has, by the suite's names; all by default. `conventions`, `order`, `step` and
    `fault` are of `ForeignBlock`. Convention start: every output is 0 until the first step. Faults
    of calls: moves when read; clamp when set, of mu_k to mu_s as it is then; state loses pending,
    what is set and not in force. On its third step it does its `misdeed`, see `foreign_face`. Plain
    is a slider as people write it, a `StepBlock`.
    """

    name: str
    vocabulary: str = "ours"
    keys: tuple[str, ...] = ()
    fmi: int = 2
    states: bool = True
    tunable: bool = True
    conventions: tuple[str, ...] = ()
    order: int = 0
    step: float = 0.0
    fault: str = ""
    misdeed: str = ""
    plain: bool = False

    @cached_property
    def rows(self) -> Mapping[str, Row]:
        mirrored = self.vocabulary == "mirrored"
        text = vocabularies.MM if mirrored else getattr(vocabularies, self.vocabulary.upper())
        rows: dict[str, Row] = {}
        for entry in vocabularies.entries(text):
            key, name, unit = [*entry, ""][:3]
            sign = -1 if name.startswith("-") or (mirrored and key in vocabularies.MIRRORED) else 1
            if self.keys and key not in self.keys:
                continue
            rows[key] = (name.lstrip("-"), unit, sign, *self._sort(key))
        return rows

    def _sort(self, key: str) -> tuple[str, str]:
        if key in INPUTS:
            return "input", "continuous"
        if key in FIXED or (key in TUNABLE and not self.tunable):
            return "parameter", "fixed"
        if key in TUNABLE:
            return "parameter", "tunable"
        return "output", "discrete" if key in ("mode", "n_slips", "sticking") else "continuous"

    @property
    def names(self) -> NameMap:
        rows = self.rows.items()
        return NameMap(
            {key: Target(name, None, 1 if sign > 0 else -1) for key, (name, _, sign, *_) in rows}
        )

    @property
    def names_file(self) -> Path:
        return self.path.with_suffix(".toml")

    @cached_property
    def path(self) -> Path:
        digest = hashlib.sha256(repr(self).encode()).hexdigest()[:12]
        return made_once(f"foreign-{digest}", self._make) / f"{self.name}.fmu"

    def opened(self, names: NameMap | None = None) -> FmuFile:
        return FmuFile(self.path, self.names if names is None else names)

    def _make(self, folder: Path) -> None:
        lines = [
            f'{key} = {{ name = "{name}", sign = {sign} }}\n'
            for key, (name, _, sign, *_) in self.rows.items()
        ]
        (folder / f"{self.name}.toml").write_text("".join(lines), encoding="utf-8")
        parts = []
        for part in ("foreign_block", "foreign_face", "step_block"):
            text = (HERE / f"{part}.py").read_text(encoding="utf-8")
            parts.append(folder / f"{part}.py")
            parts[-1].write_text(text.replace(f"from {__package__}.", "from "), encoding="utf-8")
        units = {unit: vocabularies.UNITS[unit] for _, unit, *_ in self.rows.values() if unit}
        settings = asdict(self) | {"rows": self.rows, "units": units}
        package = "pythonfmu3" if self.fmi == 3 else "pythonfmu"
        # Modules of one name are one in a process, whatever FMU they come from.
        script = folder / f"face_of_{self.name.lower()}.py"
        script.write_text(
            # The wrapper loses a reference to the globals of this file at each instance.
            f"from {package} import Fmi{self.fmi}Slave\nfrom foreign_face import KEPT, Face\n"
            "KEPT.append(globals())\n"
            f"class {self.name}(Face, Fmi{self.fmi}Slave):\n    settings = {settings!r}\n",
            encoding="utf-8",
        )
        state = "State" if self.fmi == 3 else "state"
        able = dict.fromkeys((f"canGetAndSetFMU{state}", f"canSerializeFMU{state}"), self.states)
        builder = FmuBuilder3 if self.fmi == 3 else FmuBuilder
        builder.build_FMU(script, dest=folder, project_files=parts, **able)


class Described(NamedTuple):
    name: str
    unit: str
    causality: str = "output"
    variability: str = "continuous"
    kind: str = "Real"
    text: str = ""


def description(name: str, variables: Sequence[Described]) -> str:
    units = ""
    for unit in dict.fromkeys(each.unit for each in variables if each.unit in vocabularies.UNITS):
        base = " ".join(f'{n}="{value}"' for n, value in vocabularies.UNITS[unit].items())
        units += f'<Unit name="{unit}"><BaseUnit {base}/></Unit>'
    listed = outputs = ""
    counted: Counter[str] = Counter()
    for number, each in enumerate(variables, start=1):
        more = f" unit={quoteattr(each.unit)}" if each.unit else ""
        more += "" if each.causality in ("output", "local") else ' start="1"'
        listed += (
            f'<ScalarVariable name={quoteattr(each.name)} valueReference="{counted[each.kind]}" '
            f'causality="{each.causality}" variability="{each.variability}" '
            f"description={quoteattr(each.text)}><{each.kind}{more}/></ScalarVariable>"
        )
        counted[each.kind] += 1
        outputs += f'<Unknown index="{number}"/>' if each.causality == "output" else ""
    return (
        f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{name}"><CoSimulation '
        f'modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true" '
        'canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>'
        f"<UnitDefinitions>{units}</UnitDefinitions><ModelVariables>{listed}</ModelVariables>"
        f"<ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}"
        "</InitialUnknowns></ModelStructure></fmiModelDescription>"
    )


def in_c(fmu: Path, **macros: float) -> Path:
    library, source = fmu.with_suffix(fmpy.sharedLibraryExtension), HERE / fmu.stem.lower()
    given = [f"-D{name}={value}" for name, value in macros.items()]
    given += ["-shared", "-fPIC", f"{source}.c", "-lm", "-o"]
    subprocess.run(["cc", *given, library], check=True)
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.write(f"{source}.xml", DESCRIPTION)
        for platform in (fmpy.platform, fmpy.platform_tuple):
            archive.write(library, f"binaries/{platform}/{library.name}")
    return fmu


_MACROS = {"NOMINAL": 1.0, "FRICTION": 1.0, "CREEP": 0.0}
_MACROS |= dict.fromkeys(("STEPS", "BLINDLY", "STATUS", "AGAIN", "BEHIND", "SILENT"), 0)


def solved(**macros: float) -> Path:
    def make(folder: Path) -> None:
        in_c(folder / "Solved.fmu", **_MACROS | macros)

    return made_once(f"solved-{macros}", make) / "Solved.fmu"


def altered(
    fmu: Path,
    to: Path,
    description: Callable[[str], str] = str,
    keep: Callable[[str], bool] = lambda _: True,
) -> Path:
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(to, "w") as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename == DESCRIPTION:
                content = description(content.decode("utf-8")).encode("utf-8")
            if keep(entry.filename):
                new.writestr(entry, content)
    return to


def edited(*changes: tuple[str, str]) -> Callable[[str], str]:
    def edit(text: str) -> str:
        for pattern, to in changes:
            text, count = re.subn(f"(?s){pattern}", to, text)
            assert count >= 1, pattern
        return text

    return edit


def described(to: Path, description: str) -> Path:
    with zipfile.ZipFile(to, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(DESCRIPTION, description)
    return to


MOTION = ("x", "x_dot", "x_pull", "z", "F", "F_friction")
COUNTS = ("mode", "n_slips", "sticking")
METER = ("delta_x", "spring_drop", "t_stick", "t_slip", "T", "x_dot_peak")

UNDAMPED = ("m", "g", "k", "mu_s", "mu_k", "v", *MOTION, "F_s", *COUNTS, *METER)

SLIDER = Foreign("SliderMm", "mm", UNDAMPED, states=False, tunable=False)
"""Undamped: millimetres, the spring counted in compression, no states."""

_POOR = ("m", "g", "k", "mu_s", "mu_k", "v", "x", "F")
POOR = Foreign("SliderPoor", "mm", _POOR, states=False, tunable=False)
SLIDER_3 = Foreign("SliderSi", "si", UNDAMPED, fmi=3, tunable=False)
ODD = Foreign("Odd", keys=("k", "z"), states=False)
"""No stick-slip block: one parameter, one output."""

_CONVENTIONS = ("start", "not yet", "clamp", "reversal", "first stick", "instants")
RENAMED = Foreign("Renamed", "mirrored", conventions=_CONVENTIONS)
"""The whole block by other names, units, signs and conventions."""

_FEW = ("m", "g", *TUNABLE, "x_dot_start", "z_start", *INPUTS, "x", "x_dot", "F", "sticking")
FEW = Foreign("Few", keys=_FEW, states=False, tunable=False)
"""Few outputs, and no states."""

_PLAIN = ("m", "g", *TUNABLE, "x_dot_start", "z_start", *INPUTS, *MOTION, "sticking", "mode")


def plain(name: str, **how: Any) -> Foreign:
    return Foreign(name, keys=_PLAIN, plain=True, **how)


RUNGE_KUTTA = Foreign("RungeKutta", "si", order=5, step=0.02)
"""Within 1e-10 of the exact motion."""


def misbehaving(what: str, fmi: int = 2) -> Foreign:
    return Foreign(f"Does{what.partition(' ')[0].capitalize()}", fmi=fmi, misdeed=what)

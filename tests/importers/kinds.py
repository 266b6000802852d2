"""Small FMUs with one kind of variable each, to find out which kinds an importer knows."""

from pathlib import Path

from pythonfmu import FmuBuilder

from tests.makers import altered, edited

VALUES: dict[str, tuple[object, object]] = {
    "Real": (0.5, 0.1),
    "Integer": (0, -7),
    "Boolean": (False, True),
    "Enumeration": (1, 3),
    "String": ("none", "some"),
}
"""By kind: the start value, and what a probe sets."""

_SLAVE = '''
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability
from pythonfmu.variables import {declared}


class Echo(Fmi2Slave):
    """Shows after a step what was set before it."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.given = self.shown = {start!r}
        for name in ("given", "shown"):
            causality = Fmi2Causality.input if name == "given" else Fmi2Causality.output
            start = {{"start": self.given}} if name == "given" else {{}}
            self.register_variable(
                {declared}(name, causality=causality, variability={variability}, **start)
            )

    def do_step(self, current_time, step_size):
        self.shown = self.given
        return True
'''
# What pythonfmu leaves out.
_INITIAL = ("</Outputs>", '</Outputs><InitialUnknowns><Unknown index="2"/></InitialUnknowns>')
_ITEMS = "".join(f'<Item name="n{value}" value="{value}"/>' for value in (1, 2, 3))
_CHOICE = (
    ("<Integer", '<Enumeration declaredType="Choice"'),
    ("<LogCategories>", '<TypeDefinitions><SimpleType name="Choice"><Enumeration>'
     f"{_ITEMS}</Enumeration></SimpleType></TypeDefinitions><LogCategories>"),
)  # fmt: skip


def build(kind: str, folder: Path) -> Path:
    declared = "Integer" if kind == "Enumeration" else kind
    variability = f"Fmi2Variability.{'continuous' if kind == 'Real' else 'discrete'}"
    script = folder / f"echo_{kind.lower()}.py"
    text = _SLAVE.format(declared=declared, start=VALUES[kind][0], variability=variability)
    script.write_text(text, encoding="utf-8")
    fmu = Path(FmuBuilder.build_FMU(script, dest=folder, needsExecutionTool="false"))
    more = _CHOICE if kind == "Enumeration" else ()
    return altered(fmu, folder / f"{kind}.fmu", edited(_INITIAL, *more))

"""Small FMUs with one kind of variable each, to find out which kinds an importer knows."""

import zipfile
from pathlib import Path

from pythonfmu import FmuBuilder

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
        how = {variability}
        self.register_variable(
            {declared}("given", causality=Fmi2Causality.input, start=self.given, **how)
        )
        self.register_variable({declared}("shown", causality=Fmi2Causality.output, **how))

    def do_step(self, current_time, step_size):
        self.shown = self.given
        return True
'''
_ITEMS = "".join(f'<Item name="n{value}" value="{value}"/>' for value in (1, 2, 3))
_CHOICE = (
    f'<TypeDefinitions><SimpleType name="Choice"><Enumeration>{_ITEMS}</Enumeration></SimpleType>'
    "</TypeDefinitions>\n\t<LogCategories>"
)
_INITIAL = '</Outputs><InitialUnknowns><Unknown index="2"/></InitialUnknowns>'


def build(kind: str, folder: Path) -> Path:
    """Build the FMU of one kind, a key of `VALUES`: an input `given` and an output `shown`."""
    declared = "Integer" if kind == "Enumeration" else kind
    variability = "{}" if kind == "Real" else '{"variability": Fmi2Variability.discrete}'
    script = folder / f"echo_{kind.lower()}.py"
    start, _ = VALUES[kind]
    script.write_text(
        _SLAVE.format(declared=declared, start=start, variability=variability), encoding="utf-8"
    )
    built = Path(FmuBuilder.build_FMU(script, dest=folder, needsExecutionTool="false"))
    completed = folder / f"{kind}.fmu"
    with zipfile.ZipFile(built) as source, zipfile.ZipFile(completed, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                # What pythonfmu leaves out.
                text = content.decode().replace("</Outputs>", _INITIAL)
                if kind == "Enumeration":
                    text = text.replace("<Integer", '<Enumeration declaredType="Choice"')
                    text = text.replace("<LogCategories>", _CHOICE, 1)
                content = text.encode()
            target.writestr(name, content)
    return completed

"""The files of the FMU that are there to be read, by their path in it.

Its documentation (model, interface, importing, how it was verified), the page, its icon and
terminals, and the licences of what is in it, ours and those of what it is built with.
"""

from collections.abc import Mapping
from importlib.metadata import distribution
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias

from fmi.table import Table, Variable
from stickslip.page import page
from stickslip_fmu.interface import table_of
from stickslip_fmu.laws.named import BUILT_IN, COULOMB_NAME, friction_law
from stickslip_fmu.release import DATE, VERSION
from stickslip_verification.report.files import environment, text_of

_SOURCES: Final = Path(__file__).parent
_TITLES: Final = {
    ("parameter", False): "Parameters",
    ("input", False): "Inputs",
    ("output", False): "Outputs: the motion",
    ("output", True): "Outputs: the last cycle",
}
"""The tables of the interface, by causality and whether the cycle meter holds the value."""


def document(fmi_version: int, *, native: bool = False, law: str = COULOMB_NAME) -> str:
    """Return documentation/index.html of the FMU for FMI 2.0 or 3.0 (2 or 3).

    The `native` one is the FMU in C, the other one that in Python. `law` is the name of its
    friction law, a built-in one.
    """
    own = friction_law(law).law.interface
    return rendered(
        "index.html.j2",
        fmi_version=fmi_version,
        native=native,
        licences="../licenses" if fmi_version == 2 else "licenses",
        groups=_groups(table_of(own)),
        model=own.model,
        law=law,
    )


def rendered(template: str, **names: Any) -> str:
    """Return a file of the FMU whose template lies beside this one."""
    common = {"version": VERSION, "date": DATE.partition("T")[0]}
    style = text_of("handbook.css", _SOURCES)
    return environment(_SOURCES).get_template(template).render(**common, style=style, **names)


def _groups(table: Table) -> dict[str, list[Variable]]:
    """Return the rows of the interface tables, by what they are to a user."""
    groups: dict[str, list[Variable]] = {}
    for row in table.rows:
        title = _TITLES[row.causality, row.attribute.startswith("meter.")]
        groups.setdefault(title, []).append(row)
    return groups


Runtime: TypeAlias = Mapping[str, tuple[str, bytes]]
"""Name, description and licence of each part of an FMU that is not ours."""


def _licences(runtime: Runtime) -> dict[str, bytes]:
    """Return the licence texts by file name; ``license.txt`` lists the others."""
    ours = "The block, its FMI interface and its documentation: MIT"
    entries = {"stickslip": ours, **{name: what for name, (what, _) in runtime.items()}}
    lines = [f"{what}, see {name}.txt.\n" for name, what in entries.items()]
    return {
        "license.txt": "".join(lines).encode(),
        "stickslip.txt": _licence_of("stickslip"),
        **{f"{name}.txt": text for name, (_, text) in runtime.items()},
    }


def _licence_of(package: str) -> bytes:
    for file in distribution(package).files or ():
        if file.name == "LICENSE":
            return file.read_text(encoding="utf-8").encode()
    raise FileNotFoundError(f"the installed package {package} has no file LICENSE")


def parts(
    fmi_version: Literal[2, 3] = 2, runtime: Runtime | None = None, law: str = COULOMB_NAME
) -> dict[str, bytes]:
    """Return the files that a person finds in the FMU.

    Parameters
    ----------
    fmi_version
        2 or 3: the two standards keep licences and the icon in different places.
    runtime
        None for the Python FMU. For the native one, name, description and licence of each part of a
        compiler's runtime that is in its libraries.
    law
        The friction law. One that is not built in has no documentation; the interactive page and
        the notes on reference results are about Coulomb's law.

    Returns
    -------
    dict of bytes
        ``documentation/index.html`` and what it leads to, icon, terminals, the licences.

    Raises
    ------
    FileNotFoundError
        If an installed package has lost its licence.
    """
    folder = "licenses" if fmi_version == 2 else "documentation/licenses"
    native = runtime is not None
    if runtime is None:
        what = "The binaries, and the Python package pythonfmu in resources/: MIT"
        runtime = {"pythonfmu": (what, _licence_of("pythonfmu"))}
    found = {f"{folder}/{name}": text for name, text in _licences(runtime).items()}
    for name in ("icon.png", "flange.png"):
        found[f"terminalsAndIcons/{name}"] = (_SOURCES / name).read_bytes()
    if fmi_version == 2:
        found["model.png"] = found["terminalsAndIcons/icon.png"]
    own = [row.name for row in friction_law(law).law.interface.rows if row.causality == "parameter"]
    terminals = rendered("terminalsAndIcons.xml", friction=["load", "c", *own])
    found["terminalsAndIcons/terminalsAndIcons.xml"] = terminals.encode()
    if law in BUILT_IN:
        text = document(fmi_version, native=native, law=law)
        found["documentation/index.html"] = text.encode()
    if law == COULOMB_NAME:
        found["documentation/explore.html"] = page().encode()
        found["documentation/fmi-ls-ref.html"] = rendered("fmi-ls-ref.html.j2").encode()
    return found

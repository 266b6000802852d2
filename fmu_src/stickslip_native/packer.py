"""Builds the native FMU: its description, a library for each platform, and their C sources."""

from pathlib import Path
from typing import Dict, List, Mapping, Optional
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fmi.description import Face, identity, model_description
from fmi.packer import digest_of, write_fmu
from stickslip_fmu.laws.named import COULOMB_NAME

from .compiler import FLAGS, Compiler, compiler_for
from .equations import EQUATIONS
from .named import HOME, native_law
from .platforms import Platform, universal
from .table import table_files

_MOVING = ("v", "load", "F_ext")
"""Inputs that may move within a step: core/ramp.c."""
_FOLDERS = ("core", "face")
_OTHER_FACE = {2: "fmi3", 3: "fmi2"}

_IDENTITY = """\
/* The identity of the FMU, made from its content: the GUID of FMI 2.0, the token of FMI 3.0. */
#define STICKSLIP_IDENTITY "{identity}"
/* Whether an FMU of FMI 2.0 is one for model exchange; one of FMI 3.0 has both interfaces. */
#define STICKSLIP_MODEL_EXCHANGE {model_exchange}
"""


def build(
    destination: Path,
    parts: Optional[Mapping[str, bytes]] = None,
    face: Face = 2,
    this_machine: bool = False,
    law: str = COULOMB_NAME,
    model_exchange: bool = False,
) -> Path:
    """Build the native FMU and return its file.

    Parameters
    ----------
    destination
        As of `fmi.packer.write_fmu`. In a folder the file is called after the law's model, for
        Coulomb's law StickSlip_native.
    parts
        Files that travel beside what is built here, such as documentation/index.html, by their
        path in the FMU.
    face
        The major version of FMI.
    this_machine
        Whether `cc` compiles for this machine alone, and not Zig for all platforms.
    law
        Name of a built-in friction law, as `named.native_law` takes it.
    model_exchange
        Whether the FMU of FMI 2.0 is for model exchange, and StickSlip_native_me. It is one of its
        own: there outputs depend on inputs at once, and for a master of co-simulation they must
        not. The FMU of FMI 3.0 is for both.

    Raises
    ------
    CompilerError
        If the compiler is missing or fails.
    OSError
        If the FMU cannot be written.
    ValueError
        If SOURCE_DATE_EPOCH is set to something else than whole seconds, or the friction law is
        unknown, has no native side or none for model exchange.
    """
    spec, _, whole = native_law(law)
    if whole and model_exchange:
        raise ValueError(f"the friction law {law!r} is for co-simulation, not for model exchange")
    model = spec.name
    compiler = compiler_for(this_machine)
    sources = sources_of(face, law, model_exchange)
    entries = {
        "modelDescription.xml": description(face, sources, law, model_exchange),
        **{f"sources/{name}": content for name, content in sources.items()},
        **_libraries(face, sources, compiler, model),
        **(parts or {}),
    }
    if face == 3:
        entries["sources/buildDescription.xml"] = _build_description(sources, model)
    name = f"{model}_native_me" if model_exchange else f"{model}_native"
    return write_fmu(destination, name, face, entries)


def sources_of(
    face: Face, law: str = COULOMB_NAME, model_exchange: bool = False
) -> Dict[str, bytes]:
    """Return the C sources of the FMU under a friction law by name; they lie in one folder.

    Among them are those made from the table, and identity.h with the FMU's identity.
    """
    spec, files, _ = native_law(law)
    sources = {name: text.encode() for name, text in table_files(spec).items()}
    common = [file for folder in _FOLDERS for file in HOME.glob(f"{folder}/*.[ch]")]
    for file in sorted((*common, *files)):
        if not file.name.startswith(_OTHER_FACE[face]):
            if file.name in sources:
                raise ValueError(f"two C sources have the name {file.name}")
            sources[file.name] = file.read_bytes()
    own = _identity(face, sources, model_exchange)
    text = _IDENTITY.format(identity=own, model_exchange=int(model_exchange))
    sources["identity.h"] = text.encode()
    return sources


def _libraries(
    face: Face, sources: Mapping[str, bytes], compiler: Compiler, model: str
) -> Dict[str, bytes]:
    """Return the libraries by their path; those of one folder become one universal library."""
    files: Dict[str, Dict[Platform, bytes]] = {}
    for platform in compiler.platforms:
        built = compiler.library(sources, model, platform)
        for folder in platform.folders(face):
            file = f"binaries/{folder}/{model}{platform.suffix}"
            files.setdefault(file, {})[platform] = built
    return {
        file: universal(libraries) if len(libraries) > 1 else next(iter(libraries.values()))
        for file, libraries in files.items()
    }


def description(
    face: Face,
    sources: Mapping[str, bytes],
    law: str = COULOMB_NAME,
    model_exchange: bool = False,
) -> bytes:
    """Return modelDescription.xml of the FMU with these sources."""
    spec, _, whole = native_law(law)
    compiled = _compiled(sources) if face == 2 else []
    maker, own = f"stickslip {spec.version}", _identity(face, sources, model_exchange)
    refusals = "A call was refused, and why."
    equations = EQUATIONS if not whole and (face == 3 or model_exchange) else None
    moving = () if whole or model_exchange else _MOVING
    root = model_description(spec, face, own, maker, refusals, compiled, equations, moving)
    return _text_of(root)


def _identity(face: Face, sources: Mapping[str, bytes], model_exchange: bool) -> str:
    """Return the GUID or token, made from sources, FMI version, interface, compiler options."""
    files = {name: sources[name] for name in sources.keys() - {"identity.h"}}
    return identity(digest_of(f"FMI {face} {'ME ' * model_exchange}{' '.join(FLAGS)}", files))


def _compiled(sources: Mapping[str, bytes]) -> List[str]:
    return sorted(name for name in sources if name.endswith(".c"))


def _build_description(sources: Mapping[str, bytes], model: str) -> bytes:
    """Return sources/buildDescription.xml of FMI 3.0."""
    root = Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = SubElement(root, "BuildConfiguration", {"modelIdentifier": model})
    # Fused operations give other bits.
    how = {"language": "C99", "compilerOptions": "-ffp-contract=off"}
    together = SubElement(configuration, "SourceFileSet", how)
    for name in _compiled(sources):
        SubElement(together, "SourceFile", {"name": name})
    return _text_of(root)


def _text_of(root: Element) -> bytes:
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()

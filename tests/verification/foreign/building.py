"""Builds the foreign FMUs, and others from them by changing what is in the archive."""

from __future__ import annotations

import re
import shutil
import subprocess
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import fmpy
from pythonfmu.builder import FmuBuilder
from pythonfmu3.builder import FmuBuilder as FmuBuilder3

HERE = Path(__file__).parent
DESCRIPTION = "modelDescription.xml"


def build(
    source: str,
    folder: Path,
    name: str | None = None,
    settings: Mapping[str, str] | None = None,
    **options: bool,
) -> Path:
    """Build the FMU of a source file here, under another class name and with other settings.

    A setting is a constant at the top of the source file: its name to its text. Module and class
    get the name, because modules of one name are one in a process, whatever FMU they come from.
    """
    text = (HERE / f"{source}.py").read_text(encoding="utf-8")
    face = re.search(r"class (\w+)\((?:Fmi(\d)Slave|ForeignFace)\)", text)
    assert face is not None
    name = face[1] if name is None else name
    parts = re.findall(rf"(?m)^from {__package__}\.(\w+) import", text)
    text = text.replace(face[1], name).replace(f"from {__package__}.", "from ")
    for setting, value in (settings or {}).items():
        text, changed = re.subn(rf"(?m)^{setting} = .*$", f"{setting} = {value}", text)
        assert changed == 1
    folder.mkdir(parents=True, exist_ok=True)
    script = folder / f"face_of_{name.lower()}.py"
    script.write_text(text, encoding="utf-8")
    builder = FmuBuilder3 if face[2] == "3" else FmuBuilder
    parts = [Path(shutil.copy(HERE / f"{part}.py", folder)) for part in parts]
    return Path(builder.build_FMU(script, dest=folder, project_files=parts, **options))


def pack_library(source: Path, fmu: Path, description: str, options: Sequence[str] = ()) -> Path:
    """Compile a source in C to the library of an FMU, and pack it with its description."""
    library = fmu.with_suffix(fmpy.sharedLibraryExtension)
    subprocess.run(["cc", "-shared", "-fPIC", *options, "-o", library, source, "-lm"], check=True)
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.writestr(DESCRIPTION, description)
        suffix = fmpy.sharedLibraryExtension
        folder = fmpy.platform if 'fmiVersion="2.0"' in description else fmpy.platform_tuple
        archive.write(library, f"binaries/{folder}/{fmu.stem}{suffix}")
    return fmu


def altered(
    fmu: Path,
    to: Path,
    description: Callable[[str], str] = str,
    keep: Callable[[str], bool] = lambda _: True,
) -> Path:
    """Write a copy of an FMU with its description changed and only some of its files."""
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(to, "w") as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename == DESCRIPTION:
                content = description(content.decode("utf-8")).encode("utf-8")
            if keep(entry.filename):
                new.writestr(entry, content)
    return to


def model_exchange_only(description: str) -> str:
    """Turn the co-simulation interface of an FMI 2.0 description into one for model exchange."""
    changed = description.replace("<CoSimulation", "<ModelExchange")
    changed = changed.replace("</CoSimulation", "</ModelExchange")
    return re.sub(r' canHandleVariableCommunicationStepSize="\w+"', "", changed)


def without(description: str, *names: str) -> str:
    """Take variables out of an FMI 2.0 description, and with them the model structure.

    What is left has no outputs in its structure: enough to be read and driven.
    """
    for name in names:
        pattern = rf'(?s)<ScalarVariable [^>]*name="{re.escape(name)}".*?</ScalarVariable>'
        description, changed = re.subn(pattern, "", description)
        assert changed == 1
    return re.sub(r"(?s)<ModelStructure>.*</ModelStructure>", "<ModelStructure/>", description)


def outputs(description: str) -> list[str]:
    """Return the names of the outputs of an FMI 2.0 description."""
    variables = ElementTree.fromstring(description).iter("ScalarVariable")
    return [v.get("name", "") for v in variables if v.get("causality") == "output"]

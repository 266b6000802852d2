"""The licences of what is in the FMU: ours, and those of what it is built with."""

from collections.abc import Mapping
from importlib.metadata import distribution

_WRAPPERS = {2: "pythonfmu", 3: "pythonfmu3"}
_OURS = "The block, its FMI interface and its documentation: MIT, see stickslip.txt.\n"


def licences(fmi_version: int) -> dict[str, bytes]:
    """Return the licence texts of the Python FMU, by file name; ``license.txt`` lists the others.

    Raises
    ------
    FileNotFoundError
        If an installed package has lost its licence.
    """
    wrapper = _WRAPPERS[fmi_version]
    entry = (
        f"{_OURS}"
        f"The binaries, and the Python package {wrapper} in resources/: MIT, see {wrapper}.txt.\n"
    )
    return {
        "license.txt": entry.encode(),
        "stickslip.txt": _licence_of("stickslip"),
        f"{wrapper}.txt": _licence_of(wrapper),
    }


def licences_of_native(runtime: Mapping[str, tuple[str, bytes]]) -> dict[str, bytes]:
    """Return the licence texts of the native FMU, by file name; ``license.txt`` lists the others.

    Parameters
    ----------
    runtime
        Name of each part of a compiler's runtime that is in the libraries, with what it is and the
        text of its licence.

    Raises
    ------
    FileNotFoundError
        If the installed package has lost its licence.
    """
    entry = _OURS + "".join(f"{what}, see {name}.txt.\n" for name, (what, _) in runtime.items())
    return {
        "license.txt": entry.encode(),
        "stickslip.txt": _licence_of("stickslip"),
        **{f"{name}.txt": text for name, (_, text) in runtime.items()},
    }


def _licence_of(package: str) -> bytes:
    for file in distribution(package).files or ():
        if file.name == "LICENSE":
            return file.read_text(encoding="utf-8").encode()
    raise FileNotFoundError(f"the installed package {package} has no file LICENSE")

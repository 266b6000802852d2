"""The licences of what is in the FMU: ours, and that of the wrapper it is built with."""

from importlib.metadata import distribution

_WRAPPERS = {2: "pythonfmu", 3: "pythonfmu3"}


def licences(fmi_version: int) -> dict[str, bytes]:
    """Return the licence texts, by file name; ``license.txt`` is the one to begin with.

    Raises
    ------
    FileNotFoundError
        If an installed package has lost its licence.
    """
    wrapper = _WRAPPERS[fmi_version]
    entry = (
        "The block, its FMI interface and its documentation: MIT, see stickslip.txt.\n"
        f"The binaries, and the Python package {wrapper} in resources/: MIT, see {wrapper}.txt.\n"
    )
    return {
        "license.txt": entry.encode(),
        "stickslip.txt": _licence_of("stickslip"),
        f"{wrapper}.txt": _licence_of(wrapper),
    }


def _licence_of(package: str) -> bytes:
    for file in distribution(package).files or ():
        if file.name == "LICENSE":
            return file.read_text(encoding="utf-8").encode()
    raise FileNotFoundError(f"the installed package {package} has no file LICENSE")

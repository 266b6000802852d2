"""What each package takes from outside; arrows between ours stand in `pyproject.toml`."""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from fmi.packer import travelling
from stickslip_fmu.packer import MAIN
from tests.python import python, run

ROOT = Path(__file__).parents[1]
FOLDERS = {
    folder.name: folder
    for floor in ("fmu_src", "src", "verification", "workbench")
    for folder in sorted((ROOT / floor).iterdir())
    if (folder / "__init__.py").exists()
}
OUTSIDE = {
    "fmi": "pythonfmu",
    "stickslip_fmu": "",
    "stickslip_native": "",
    "stickslip_ref": "numpy scipy",
    "stickslip_units": "numpy",
    "stickslip_verification": "numpy scipy mpmath fmpy pydantic pydantic_core lazy_loader jinja2 "
    "markupsafe matplotlib",
    "stickslip_verification.truth": "mpmath",
    "stickslip_score": "numpy scipy mpmath lazy_loader",
    "stickslip_design": "numpy scipy mpmath matplotlib xarray fmpy lazy_loader markupsafe PIL "
    "contourpy threadpoolctl pydantic fsspec tomlkit",
    "stickslip": "numpy scipy matplotlib typer rich fmpy jinja2 markupsafe xarray pandas "
    "lazy_loader",
}
"""What a package, or a folder of it, may import from outside beside the standard library."""
HEAVY = ("numpy", "scipy", "fmpy", "matplotlib", "pythonfmu", "mpmath", "xarray")


def imports(file: Path) -> Iterator[tuple[str, str]]:
    for node in ast.walk(ast.parse(file.read_text("utf-8"), str(file))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            yield from ((node.module, alias.name) for alias in node.names)


@pytest.mark.parametrize("package", OUTSIDE)
def test_a_package_imports_from_outside_what_is_listed(package: str) -> None:
    name, *inner = package.split(".")
    allowed = {*FOLDERS, *OUTSIDE[package].split(), *sys.stdlib_module_names}
    files = FOLDERS[name].joinpath(*inner).rglob("*.py")
    found = {(file.name, module) for file in files for module, _ in imports(file)}
    assert not {each for each in found if each[1].partition(".")[0] not in allowed}


def test_the_verification_takes_the_reference_by_its_front_door() -> None:
    files = FOLDERS["stickslip_verification"].rglob("*.py")
    assert not {module for file in files for module, _ in imports(file)} & {
        module
        for file in FOLDERS["stickslip_ref"].rglob("*.py")
        if (module := ".".join(file.relative_to(ROOT / "src").with_suffix("").parts))
    }


def test_what_travels_in_the_fmu_runs_on_python_3_8(tmp_path: Path) -> None:
    packed = travelling(MAIN)
    assert len(packed) > 20
    for name, content in packed.items():
        (tmp_path / name.replace("/", "-")).write_bytes(content)
    vermin = Path(sys.executable).with_name("vermin")
    options = ["--target=3.8-", "--violations", "--eval-annotations", "--no-tips"]
    done = run(vermin, *options, tmp_path)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    "arguments", [["--help"], ["simulate", "--help"], ["design", "--help"], ["--version"]]
)
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    program = (
        "import sys\n"
        "from stickslip.cli import main\n"
        "sys.argv = ['stickslip', *sys.argv[1:]]\n"
        "try:\n"
        "    main()\n"
        "finally:\n"
        f"    print('loaded:', *[name for name in {HEAVY!r} if name in sys.modules])\n"
    )
    assert python("-c", program, *arguments).stdout.splitlines()[-1] == "loaded:"

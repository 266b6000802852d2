"""What each package needs from outside and takes of its neighbours, and what travels in the FMU.

The arrows between packages and rooms stand in `pyproject.toml`, for import-linter.
"""

import ast
import builtins
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.machinery import PathFinder
from pathlib import Path

import pytest

from fmukit.packer import travelling
from stickslip_fmu.packer import MAIN
from tests.python import python

OURS = (
    "fmukit",
    "stickslip_fmu",
    "stickslip_native",
    "stickslip_ref",
    "stickslip_verification",
    "stickslip_score",
    "stickslip_design",
    "stickslip",
)


# What a package, or a room of it, may import from outside beside the standard library.
OUTSIDE = {
    "fmukit": frozenset[str](),
    "stickslip_fmu": frozenset[str](),
    "stickslip_native": frozenset[str](),
    "stickslip_ref": frozenset({"numpy", "scipy"}),
    "stickslip_verification": frozenset({"numpy", "mpmath", "fmpy", "jsonschema", "lazy_loader"}),
    "stickslip_verification.truth": frozenset({"mpmath"}),
    "stickslip_score": frozenset({"lazy_loader", "mpmath", "numpy", "scipy"}),
    "stickslip_design": frozenset({"lazy_loader", "mpmath", "numpy", "scipy"}),
    "stickslip": frozenset({"typer", "rich", "matplotlib", "numpy"}),
}

COMPUTED = "a module with a computed name"
"""What an import shows whose name stands in no text, such as that of a friction law."""

# Single modules that need more from outside than the rest of their package.
EXTRA_OUTSIDE = {
    ("stickslip", "simulate.csv_file"): frozenset({"fmpy"}),
    ("stickslip", "show.curve"): frozenset({"scipy"}),
    ("stickslip", "handbook.document"): frozenset({"jinja2", "markupsafe", "rcssmin"}),
    ("stickslip", "page.assemble"): frozenset({"jinja2", "rcssmin"}),
    ("stickslip", "page.minify"): frozenset({"rjsmin"}),
    ("stickslip", "page.texts"): frozenset({"jinja2"}),
    ("stickslip_fmu", "laws.named"): frozenset({COMPUTED}),
    ("stickslip_ref", "laws.named"): frozenset({COMPUTED}),
    ("stickslip_verification", "truth.named"): frozenset({COMPUTED}),
    ("fmukit", "fmi2.face"): frozenset({"pythonfmu"}),
    ("fmukit", "fmi3.face"): frozenset({"pythonfmu3"}),
    ("fmukit", "packer"): frozenset({"pythonfmu", "pythonfmu3"}),
    ("stickslip_design", "claims.plots"): frozenset({"matplotlib"}),
    ("stickslip_design", "cures"): frozenset({"scipy"}),
    ("stickslip", "commands.map"): frozenset({"xarray"}),
    ("stickslip", "show.sweep_summary"): frozenset({"xarray"}),
    ("stickslip_design", "datasets"): frozenset({"xarray", COMPUTED}),
    # Pillow and contourpy come with matplotlib.
    ("stickslip_design", "maps.page"): frozenset({"markupsafe", "matplotlib", "PIL"}),
    ("stickslip_design", "maps.pictures"): frozenset({"matplotlib"}),
    ("stickslip_design", "maps.study"): frozenset({"xarray"}),
    ("stickslip_design", "maps.views"): frozenset({"contourpy", "xarray"}),
    ("stickslip_design", "sweeps.runner"): frozenset({"fmpy"}),
    ("stickslip_design", "sweeps.ssp"): frozenset({"fmpy"}),
    ("stickslip_design", "sweeps.study"): frozenset({"xarray"}),
    ("stickslip_design", "tolerances.page"): frozenset({"markupsafe", "matplotlib"}),
    ("stickslip_design", "tolerances.pictures"): frozenset({"matplotlib"}),
    ("stickslip_design", "tolerances.result"): frozenset({"xarray"}),
    ("stickslip_design", "tolerances.study"): frozenset({"xarray"}),
    ("stickslip_design", "report.page"): frozenset({"markupsafe", "matplotlib"}),
    ("stickslip_design", "report.plots"): frozenset({"matplotlib"}),
    ("stickslip_verification", "report.curve"): frozenset({"scipy"}),
    ("stickslip_verification", "report.house_style"): frozenset({"matplotlib"}),
    ("stickslip_verification", "report.environment"): frozenset({"jinja2", "markupsafe"}),
    ("stickslip_verification", "report.html"): frozenset({"markupsafe"}),
    ("stickslip_verification", "report.order_plot"): frozenset({"matplotlib"}),
    ("stickslip_verification", "report.pdf"): frozenset({"weasyprint"}),
    ("stickslip_verification", "report.plots"): frozenset({"matplotlib"}),
    ("stickslip_verification", "report.svg.figure"): frozenset({"matplotlib"}),
}


@dataclass(frozen=True)
class Import:
    """One imported module: where it stands and its dotted name."""

    file: Path
    line: int
    module: str

    @property
    def top(self) -> str:
        """The top-level package."""
        return self.module.partition(".")[0]

    def __str__(self) -> str:
        return f"{self.file.name}:{self.line} imports {self.module}"


def folder_of(package: str) -> Path:
    """Give the folder of an importable package."""
    # Where it is found now, and not where a module of this name was loaded from.
    spec = PathFinder.find_spec(package)
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).parent


def modules_of(package: str) -> list[Path]:
    """Give the files of a package, those in its subpackages too."""
    return sorted(folder_of(package).rglob("*.py"))


def name_of(package: str, file: Path) -> str:
    """Give the module's dotted name inside its package, such as `fmi2` or `drive.reference`."""
    return ".".join(file.relative_to(folder_of(package)).with_suffix("").parts)


def imports_in(file: Path, tree: ast.AST, package: str) -> Iterator[Import]:
    """Give every import of a file, wherever it stands: in functions and under conditions too."""
    inside = (package, *name_of(package, file).split("."))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield Import(file, node.lineno, alias.name)
        elif isinstance(node, ast.ImportFrom):
            base = inside[: len(inside) - node.level] if node.level else ()
            module = ".".join((*base, *([node.module] if node.module else [])))
            for alias in node.names:
                yield Import(file, node.lineno, f"{module}.{alias.name}")
        elif isinstance(node, ast.Call) and called_name(node) in {"import_module", "__import__"}:
            yield Import(file, node.lineno, imported_by_call(node, package))


def imported_by_call(call: ast.Call, package: str) -> str:
    """Give the module that a call of `import_module` names, as far as its text shows."""
    match call.args:
        case [ast.Constant(value=str(name))]:
            return name
        case [ast.JoinedStr(values=[ast.FormattedValue(value=ast.Name(id="__name__")), *_])]:
            return package
        case [ast.JoinedStr(values=[ast.Constant(value=str(text)), *_]), _] if text[:1] == ".":
            # Relative to a package: whichever that is, its own modules.
            return package
        case _:
            return COMPUTED


def called_name(call: ast.Call) -> str:
    """Give the last name of what is called, or nothing."""
    if isinstance(call.func, ast.Name):
        return call.func.id
    return call.func.attr if isinstance(call.func, ast.Attribute) else ""


@pytest.mark.parametrize("package", OURS)
def test_each_package_needs_from_outside_what_is_listed(package: str) -> None:
    """A package, and a room with a list of its own, imports no library that is not listed."""
    wrong = []
    for file in modules_of(package):
        name = name_of(package, file)
        room = f"{package}.{name.partition('.')[0]}"
        outside = OUTSIDE.get(room, OUTSIDE[package]) | EXTRA_OUTSIDE.get((package, name), set())
        allowed = {*OURS, *outside, *sys.stdlib_module_names}
        tree = ast.parse(file.read_text(encoding="utf-8"), filename=str(file))
        wrong += [
            str(found) for found in imports_in(file, tree, package) if found.top not in allowed
        ]
    assert not wrong


@pytest.mark.parametrize("package", OURS)
def test_only_public_names_cross_the_floors(package: str) -> None:
    """What a package takes from another package of the house has no leading underscore."""
    private = []
    for file in modules_of(package):
        tree = ast.parse(file.read_text(encoding="utf-8"), filename=str(file))
        private += [
            str(found)
            for found in imports_in(file, tree, package)
            if found.top in OURS
            and found.top != package
            and any(part.startswith("_") for part in found.module.split("."))
        ]
    assert not private


def test_the_verification_takes_the_reference_by_its_front_door() -> None:
    """The first floor uses what `stickslip_ref` exports and none of its inner modules."""
    inner = []
    for file in modules_of("stickslip_verification"):
        tree = ast.parse(file.read_text(encoding="utf-8"), filename=str(file))
        inner += [
            str(found)
            for found in imports_in(file, tree, "stickslip_verification")
            if found.top == "stickslip_ref" and is_module_inside(found.module)
        ]
    assert not inner


def is_module_inside(dotted: str) -> bool:
    """Tell whether `stickslip_ref.a.b` goes through a module `a` rather than a name of the door."""
    parts = dotted.split(".")[1:]
    folder = folder_of("stickslip_ref")
    return len(parts) > 1 and any(
        (folder / inside).exists() for inside in (parts[0], f"{parts[0]}.py")
    )


def test_what_travels_in_the_fmu_is_python_3_8() -> None:
    """Every module in the FMU has the syntax and the library of Python 3.8."""
    packed = {**travelling(MAIN, 2), **travelling(MAIN, 3)}
    assert len(packed) > 20
    problems = []
    for name, content in packed.items():
        problems += [f"{name}:{text}" for text in newer_than_3_8(content.decode("utf-8"))]
    assert not problems


NEWER_ATTRIBUTES = {
    "math": {"nextafter", "ulp", "lcm", "cbrt", "exp2", "sumprod", "fma"},
    "functools": {"cache"},
    "itertools": {"pairwise", "batched"},
    "typing": {"TypeAlias", "Annotated", "ParamSpec", "Concatenate", "TypeGuard", "Self", "Never",
               "assert_never", "assert_type", "LiteralString", "NotRequired", "Required", "Unpack",
               "override", "reveal_type"},
    "contextlib": {"aclosing", "chdir"},
    "datetime": {"UTC"},
    "enum": {"StrEnum", "verify", "member", "nonmember"},
    "random": {"randbytes"},
    "types": {"NoneType", "EllipsisType", "UnionType", "GenericAlias"},
}  # fmt: skip
NEWER_MODULES = {"zoneinfo", "graphlib", "tomllib"}
NEWER_METHODS = {"removeprefix", "removesuffix", "bit_count", "is_relative_to", "with_stem",
                 "readlink", "hardlink_to"}  # fmt: skip
NEWER_BUILTINS = {"aiter", "anext", "EncodingWarning", "ExceptionGroup", "BaseExceptionGroup"}
NEWER_KEYWORDS = {("zip", "strict"), ("dataclass", "slots"), ("dataclass", "kw_only"),
                  ("dataclass", "match_args"), ("field", "kw_only")}  # fmt: skip
GENERIC_BUILTINS = {"list", "dict", "tuple", "set", "frozenset", "type"}
GENERIC_ABCS = {"Callable", "Iterable", "Iterator", "Mapping", "MutableMapping", "Sequence",
                "MutableSequence", "Generator", "Collection", "Set", "MutableSet", "deque", "Match",
                "defaultdict", "OrderedDict", "Counter", "ChainMap", "Pattern"}  # fmt: skip


def newer_than_3_8(source: str) -> list[str]:
    """Give line and reason of everything in `source` that Python 3.8 lacks."""
    try:
        tree = ast.parse(source, feature_version=(3, 8))
    except SyntaxError as error:
        return [f"{error.lineno} {error.msg}"]
    found: list[tuple[int, str]] = []
    postponed = any(
        isinstance(node, ast.ImportFrom)
        and node.module == "__future__"
        and any(alias.name == "annotations" for alias in node.names)
        for node in tree.body
    )
    unevaluated = annotation_nodes(tree) if postponed else set()
    abcs = names_from(tree, {"collections", "collections.abc", "re"})
    for node in ast.walk(tree):
        line = getattr(node, "lineno", 0)
        found += [(line, text) for text in newer_syntax(node)]
        found += [(line, text) for text in newer_library(node)]
        if node not in unevaluated:
            found += [(line, text) for text in newer_typing(node, abcs)]
    return [f"{line} {text}" for line, text in sorted(found)]


def annotation_nodes(tree: ast.AST) -> set[ast.AST]:
    """Give every node inside an annotation."""
    roots: list[ast.AST | None] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            roots.append(node.returns)
        elif isinstance(node, ast.arg | ast.AnnAssign):
            roots.append(node.annotation)
    return {inner for root in roots if root is not None for inner in ast.walk(root)}


def names_from(tree: ast.AST, modules: set[str]) -> set[str]:
    """Give the names imported from these modules."""
    return {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module in modules
        for alias in node.names
    }


def newer_syntax(node: ast.AST) -> Iterator[str]:
    """Tell of the newer syntax that `ast.parse` lets pass at feature_version 3.8."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        for decorator in node.decorator_list:
            plain = decorator.func if isinstance(decorator, ast.Call) else decorator
            while isinstance(plain, ast.Attribute):
                plain = plain.value
            if not isinstance(plain, ast.Name):
                yield "decorator that is no dotted name (3.9)"
    elif (
        isinstance(node, ast.Subscript)
        and isinstance(node.slice, ast.Tuple)
        and any(isinstance(element, ast.Starred) for element in node.slice.elts)
    ):
        yield "starred subscript (3.11)"


def newer_library(node: ast.AST) -> Iterator[str]:
    """Tell of modules, functions, methods and arguments that Python 3.8 lacks."""
    if isinstance(node, ast.Import):
        for alias in node.names:
            if alias.name.partition(".")[0] in NEWER_MODULES:
                yield f"module {alias.name} (3.9 or later)"
    elif isinstance(node, ast.ImportFrom):
        if (node.module or "") in NEWER_MODULES:
            yield f"module {node.module} (3.9 or later)"
        for alias in node.names:
            if alias.name in NEWER_ATTRIBUTES.get(node.module or "", set()):
                yield f"{node.module}.{alias.name} (3.9 or later)"
    elif isinstance(node, ast.Attribute):
        owner = node.value.id if isinstance(node.value, ast.Name) else ""
        if node.attr in NEWER_ATTRIBUTES.get(owner, set()):
            yield f"{owner}.{node.attr} (3.9 or later)"
        elif node.attr in NEWER_METHODS:
            yield f".{node.attr}() (3.9 or later)"
    elif isinstance(node, ast.Name) and node.id in NEWER_BUILTINS:
        yield f"{node.id} (3.10 or later)"
    elif isinstance(node, ast.Call):
        for keyword in node.keywords:
            if (called_name(node), keyword.arg) in NEWER_KEYWORDS:
                yield f"{called_name(node)}({keyword.arg}=) (3.10)"
        if called_name(node) == "isinstance" and any(
            isinstance(argument, ast.BinOp) for argument in node.args[1:]
        ):
            yield "isinstance with a union (3.10)"


def newer_typing(node: ast.AST, abcs: set[str]) -> Iterator[str]:
    """Tell of types that Python 3.8 cannot evaluate."""
    if isinstance(node, ast.Subscript):
        value = node.value
        if isinstance(value, ast.Name):
            if value.id in GENERIC_BUILTINS:
                yield f"{value.id}[...] evaluated (3.9)"
            elif value.id in GENERIC_ABCS & abcs:
                yield f"collections.abc.{value.id}[...] evaluated (3.9)"
    elif (
        isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.BitOr)
        and (is_type(node.left) or is_type(node.right))
    ):
        yield "union of types evaluated (3.10)"


def is_type(node: ast.expr) -> bool:
    """Tell whether an operand of | is a type or None, as far as its text shows."""
    if isinstance(node, ast.Constant):
        return node.value is None
    if isinstance(node, ast.Name):
        return isinstance(getattr(builtins, node.id, None), type)
    return isinstance(node, ast.Subscript) and is_type(node.value)


@pytest.mark.parametrize(
    "source",
    [
        "match x:\n    case 1: pass",
        "with (open('a') as a, open('b') as b): pass",
        "with (\n    open('a') as a,\n    open('b') as b,\n): pass",
        "def f(x: int | None): pass",
        "x: list[int] = []",
        "from __future__ import annotations\nA = list[int]",
        "from __future__ import annotations\nA = int | None",
        "from collections.abc import Callable\ndef f(x: Callable[[], int]): pass",
        "import math\nmath.nextafter(1.0, 2.0)",
        "from math import ulp",
        "from functools import cache",
        "'ab'.removeprefix('a')",
        "zip(a, b, strict=True)",
        "@dataclass(slots=True)\nclass A: pass",
        "try: pass\nexcept* ValueError: pass",
        "@a[0].b\ndef f(): pass",
        "isinstance(x, int | str)",
        "import tomllib",
    ],
)
def test_the_reader_of_python_3_8_knows_what_is_newer(source: str) -> None:
    """Each of these fails on Python 3.8 and is told so."""
    assert newer_than_3_8(source)


@pytest.mark.parametrize(
    "source",
    [
        "if (n := 3) > 2: pass",
        "from __future__ import annotations\ndef f(x: int | None) -> list[int]: pass",
        "from __future__ import annotations\nx: dict[str, int] = {}",
        "with open('a') as a, open('b') as b: pass",
        "with (yield_one()) as a: pass",
        "from typing import Dict\nA = Dict[str, int]",
        "a = flags | 1",
        "def f(a, /, b): pass",
        "import math\nmath.comb(3, 2)",
    ],
)
def test_the_reader_of_python_3_8_lets_it_pass(source: str) -> None:
    """Each of these is Python 3.8."""
    assert not newer_than_3_8(source)


HEAVY = ("numpy", "scipy", "fmpy", "matplotlib", "pythonfmu", "mpmath")


@pytest.mark.parametrize(
    "arguments", [["--help"], ["simulate", "--help"], ["design", "--help"], ["--version"]]
)
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    """Asking the command for help or for its version costs no numerical library."""
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

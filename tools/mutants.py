"""Measures how strong the tests are: 100 small faults, planted one by one in a copy of the tree.

``python tools/mutants.py run RESULTS`` draws the mutants with a fixed seed, runs the tests that
could see each one and writes what detected it; what is in the file already is not run again, so an
ended run goes on. ``--tree`` measures another checkout, whose tests are then run. The tests of all
parts come first, then the files of a part's folders, the cheapest first, as `COSTS` of an earlier
run says (``make test`` writes it). Those that fit into 60 CPU seconds decide for most, and only
survivors meet the others.
"""

import argparse
import ast
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

SEED = 28
PARTS = {
    "block": (35, "fmu_src/stickslip_fmu/{block,meter,laws/**/*,numerics/**/*}.py"),
    "reference": (25, "src/stickslip_ref/**/*.py"),
    "truth": (15, "verification/stickslip_verification/truth/**/*.py"),
    "judge and drive": (15, "verification/stickslip_verification/{judge,drive}/**/*.py"),
    "C": (10, "fmu_src/stickslip_native/{core,face}/*.c"),
}
"""Number of mutants and source files of each part."""
TESTS = {
    "block": ("fmu", "laws", "native", "verification"),
    "reference": ("ref", "laws", "verification", "design"),
    "truth": ("verification", "laws", "score"),
    "judge and drive": ("verification", "score"),
    "C": ("native", "fmu", "laws"),
}
"""Folders of `tests/` that could see a mutant of each part, and what tests all parts alike."""
SHARED = ("facts",)
QUICK = 60.0
"""CPU seconds of the tests that every mutant meets."""

_TURNED = {
    ast.Lt: ">",
    ast.Gt: "<",
    ast.LtE: ">=",
    ast.GtE: "<=",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.Is: "is not",
    ast.IsNot: "is",
    ast.In: "not in",
    ast.NotIn: "in",
}
_OTHER = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*"}
_C_CHANGES = (
    ("comparison", re.compile(r" (<|>|<=|>=|==|!=) "), None),
    ("sign", re.compile(r" ([+-]) "), None),
    ("constant", re.compile(r"(?<![\w.])(\d+\.\d+(?:e-?\d+)?)(?![\w.])"), r"(1.5 * \1 + 0.5)"),
    ("branch", re.compile(r"\bif \((.+)\)(?= \{?$)"), "if (0)"),
    ("state", re.compile(r"^ +[\w>.\[\]-]+(?:->|\.)\w+ = [^;]+;$"), "    ;"),
)
_C_TURNED = {"<": ">", ">": "<", "<=": ">=", ">=": "<=", "==": "!=", "!=": "==", "+": "-", "-": "+"}


@dataclass(frozen=True)
class Mutant:
    """One change of a source file: the text at an offset becomes another."""

    part: str
    file: str
    line: int
    offset: int
    kind: str
    old: str
    new: str

    @property
    def name(self) -> str:
        """Name in the results."""
        return f"{self.file}:{self.line} {self.kind}: {self.old} -> {self.new}"


def draw(tree: Path) -> list[Mutant]:
    """Return the mutants, the kinds of change equally likely in each part."""
    drawn = []
    for part, (count, pattern) in PARTS.items():
        chance = random.Random(f"{SEED} {part}")
        by_kind: dict[str, list[Mutant]] = {}
        for file in _files(tree, pattern):
            for mutant in _candidates(part, file.relative_to(tree).as_posix(), file.read_text()):
                by_kind.setdefault(mutant.kind, []).append(mutant)
        for _ in range(count):
            candidates = by_kind[chance.choice(sorted(by_kind))]
            drawn.append(candidates.pop(chance.randrange(len(candidates))))
    return drawn


def _files(tree: Path, pattern: str) -> Iterator[Path]:
    start, inner, rest = re.fullmatch(r"([^{]*)\{?([^}]*)\}?(.*)", pattern).groups()  # type: ignore[union-attr]
    for each in inner.split(",") if "{" in pattern else [""]:
        yield from sorted(tree.glob(start + each + rest))


def _candidates(part: str, file: str, text: str) -> Iterator[Mutant]:
    changes = _changes_in_c(text) if file.endswith(".c") else _changes_in_python(text)
    for kind, start, end, new in changes:
        line = text.count("\n", 0, start) + 1
        yield Mutant(part, file, line, start, kind, text[start:end], new)


def _changes_in_c(text: str) -> Iterator[tuple[str, int, int, str]]:
    begin = 0
    for line in text.splitlines(keepends=True):
        code = line.rstrip("\n")
        if code.startswith("    ") and not re.match(r" *(/\*|\*|//|static|for)|.*\"", code):
            for kind, pattern, new in _C_CHANGES:
                for match in pattern.finditer(code):
                    group = 1 if new is None else 0
                    start, end = (begin + each for each in match.span(group))
                    yield kind, start, end, match.expand(new) if new else _C_TURNED[match[1]]
        begin += len(line)


def _changes_in_python(text: str) -> Iterator[tuple[str, int, int, str]]:
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line.encode()))

    def at(node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        ends = (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)
        source = text.encode()
        first, last = (len(source[: starts[row - 1] + column].decode()) for row, column in ends)
        return first, last

    for node in _inside_functions(ast.parse(text)):
        shown = ast.unparse
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            turned = f"{shown(node.left)} {_TURNED[type(node.ops[0])]} {shown(node.comparators[0])}"
            yield "comparison", *at(node), f"({turned})"
        elif isinstance(node, ast.BinOp) and type(node.op) in _OTHER:
            left, right = f"({shown(node.left)})", f"({shown(node.right)})"
            yield "sign", *at(node), f"({left} {_OTHER[type(node.op)]} {right})"
            if isinstance(node.op, ast.Add | ast.Sub):
                yield "term", *at(node), left
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield "sign", *at(node), f"({shown(node.operand)})"
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            if isinstance(node.value, bool):
                continue
            other = node.value + 1 if isinstance(node.value, int) else 1.5 * node.value + 0.5
            yield "constant", *at(node), f"({other!r})"
        elif isinstance(node, ast.If | ast.While):
            yield "branch", *at(node.test), "False"
        elif isinstance(node, ast.Assign | ast.AugAssign) and "self." in shown(node).split("=")[0]:
            yield "state", *at(node), "pass"


def _inside_functions(tree: ast.AST) -> Iterator[ast.AST]:
    functions = [each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef)]
    seen: set[int] = set()
    for function in functions:
        for statement in function.body:
            for node in ast.walk(statement):
                # The error's words are no physics.
                if isinstance(node, ast.Raise | ast.JoinedStr):
                    seen.update(id(each) for each in ast.walk(node))
                if id(node) not in seen:
                    seen.add(id(node))
                    yield node


class Bench:
    """Copies of a tree in which mutants are tried."""

    def __init__(self, tree: Path, costs: dict[str, float], python: str) -> None:
        self.tree, self.costs, self.python = tree, costs, python
        self.folder = Path(tempfile.mkdtemp(prefix="mutants-"))
        self.local = threading.local()

    def copy(self) -> Path:
        """Return this thread's copy of the tree."""
        if not hasattr(self.local, "copy"):
            self.local.copy = self.folder / str(threading.get_ident())
            shutil.copytree(self.tree, self.local.copy, ignore=self._left_out)
        copy: Path = self.local.copy
        return copy

    def _left_out(self, folder: str, names: list[str]) -> list[str]:
        made = (".git", ".venv", "build", "report") if Path(folder) == self.tree else ()
        return [name for name in names if name in made or name == "__pycache__"]

    def tried(self, mutant: Mutant) -> str | None:
        """Return the test that detects a mutant, or None."""
        file = self.copy() / mutant.file
        text = file.read_text()
        end = mutant.offset + len(mutant.old)
        assert text[mutant.offset : end] == mutant.old
        file.write_text(text[: mutant.offset] + mutant.new + text[end:])
        try:
            quick, others = self._picked(mutant.part)
            # What a compiler is needed for is of the gate.
            more = ["--gate"] if mutant.part == "C" else []
            return self._failing(quick, more) or self._failing(others, more)
        finally:
            file.write_text(text)

    def _picked(self, part: str) -> tuple[list[str], list[str]]:
        files = sorted(
            (folder not in SHARED, self.costs.get(str(file.relative_to(self.copy())), 1.0), file)
            for folder in (*TESTS[part], *SHARED)
            for file in (self.copy() / "tests" / folder).rglob("test_*.py")
            # Other machines' libraries are tried by `make native-platforms` alone; the workers of
            # a killed study import what is installed, and not the copy.
            if "platforms" not in file.parts and "chunks" not in file.parts
        )
        quick: list[str] = []
        others: list[str] = []
        spent = 0.0
        for _, cost, file in files:
            spent += cost
            (quick if spent < QUICK else others).append(str(file))
        return quick, others

    def _failing(self, files: list[str], more: list[str]) -> str | None:
        if not files:
            return None
        copy = self.copy()
        roots = [copy / name for name in ("src", "fmu_src", "verification", "workbench")]
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join(map(str, (*roots, copy))),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        seconds = 120 + 4 * sum(self.costs.get(str(Path(x).relative_to(copy)), 1.0) for x in files)
        options = ["-x", "-q", "--tb=no", "-rfE", "-p", "no:cacheprovider", "-p", "no:randomly"]
        with subprocess.Popen(
            [self.python, "-m", "pytest", *options, *more, *files],
            cwd=copy,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        ) as running:
            try:
                said = running.communicate(timeout=seconds)[0]
            except subprocess.TimeoutExpired:
                os.killpg(running.pid, signal.SIGKILL)
                return "a test that does not end"
        failed = re.search(r"^(?:FAILED|ERROR) (\S+)", said, re.MULTILINE)
        return failed[1] if failed else None if running.returncode == 0 else said[-300:]


def main() -> None:
    """Draw the mutants, try those without a result, write the results."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("action", choices=("list", "run"))
    parser.add_argument("results", type=Path, nargs="?")
    parser.add_argument("--tree", type=Path, default=Path(__file__).parents[1])
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--costs", type=Path, help="JSON: CPU seconds of each test file")
    parser.add_argument("--jobs", type=int, default=1)
    asked = parser.parse_args()
    mutants = draw(asked.tree)
    if asked.action == "list":
        print(*(each.name for each in mutants), sep="\n")
        return
    results = json.loads(asked.results.read_text()) if asked.results.exists() else {}
    costs = json.loads(asked.costs.read_text()) if asked.costs else {}
    bench = Bench(asked.tree.resolve(), costs, asked.python)
    lock = threading.Lock()

    def measure(mutant: Mutant) -> None:
        detected = bench.tried(mutant)
        with lock:
            results[mutant.name] = {**asdict(mutant), "detected by": detected}
            rows = (f"{json.dumps(name)}: {json.dumps(of)}" for name, of in results.items())
            asked.results.write_text("{\n" + ",\n".join(rows) + "\n}\n")
            print(f"{detected or 'SURVIVES'}: {mutant.name}", flush=True)

    try:
        with ThreadPoolExecutor(asked.jobs) as pool:
            list(pool.map(measure, (each for each in mutants if each.name not in results)))
    finally:
        shutil.rmtree(bench.folder, ignore_errors=True)
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    survivors = [name for name, each in results.items() if each["detected by"] is None]
    print(
        f"{len(survivors)} of {len(results)} survive, {spent.ru_utime + spent.ru_stime:.0f} CPU s"
    )


if __name__ == "__main__":
    main()

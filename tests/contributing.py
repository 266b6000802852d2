"""CONTRIBUTING.md as its reader takes it: blocks saved, diffs applied, lines of the shell run."""

import os
import re
import shutil
import sys
import textwrap
from collections.abc import Iterable
from pathlib import Path

from tests.python import run

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def section(title: str) -> str:
    return TEXT[TEXT.index(f"## {title}\n") :].split("\n## ")[0]


def blocks(title: str, language: str) -> list[str]:
    """Return the blocks of a section in a language, without their indentation."""
    pattern = rf"^( *)```{language}\n(.*?)^ *```$"
    found = re.findall(pattern, section(title), re.DOTALL | re.MULTILINE)
    return [textwrap.dedent(block) for _, block in found]


def applied(diff: str, root: Path) -> list[Path]:
    """Apply a diff without line numbers: what each hunk takes away must be there exactly once."""
    changed = []
    for part in diff.split("--- a/")[1:]:
        name, _, hunks = part.partition("\n+++ b/")
        file = root / name
        text = file.read_text(encoding="utf-8")
        for hunk in hunks.split("\n@@\n")[1:]:
            lines = hunk.rstrip("\n").split("\n")
            old = "\n".join(line[1:] for line in lines if line[:1] != "+")
            new = "\n".join(line[1:] for line in lines if line[:1] != "-")
            assert text.count(old) == 1, f"{name}: {old}"
            text = text.replace(old, new)
        file.write_text(text, encoding="utf-8")
        changed.append(file)
    return changed


def copied(names: Iterable[str], target: Path) -> None:
    for name in names:
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_dir():
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(ROOT / name, target / name, ignore=ignored)
        else:
            shutil.copy(ROOT / name, target / name)


def walk(commands: str, folder: Path, **environment: str) -> str:
    """Run lines of the shell, all of which must succeed, in a folder; return what they print."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    env = {**os.environ, "PATH": path, **environment}
    done = run("/bin/sh", "-e", "-c", commands, cwd=folder, env=env, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout

"""CONTRIBUTING.md as its reader takes it: blocks saved, lines of the shell run."""

import os
import re
import sys
import textwrap
from pathlib import Path

from tests.python import run

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def section(title: str) -> str:
    return TEXT[TEXT.index(f"## {title}\n") :].split("\n## ")[0]


def blocks(title: str, language: str) -> list[str]:
    pattern = rf"^( *)```{language}\n(.*?)^ *```$"
    found = re.findall(pattern, section(title), re.DOTALL | re.MULTILINE)
    return [textwrap.dedent(block) for _, block in found]


def walk(commands: str, folder: Path, **environment: str) -> str:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    env = {**os.environ, "PATH": path, **environment}
    done = run("/bin/sh", "-e", "-c", commands, cwd=folder, env=env, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout

"""The page's script: its modules joined into one, in the order in which they need each other.

A browser loads no modules from a file without a server, so the lines of import and export go and
the modules share one scope; a name that two of them use is refused.
"""

import posixpath
import re
from collections.abc import Mapping
from graphlib import TopologicalSorter
from typing import Final

_IMPORT: Final = re.compile(r'^import \{[^}]*\} from "(?P<path>\.[^"]*)";\n', re.MULTILINE)
_EXPORT: Final = re.compile(r"^export (?=(?:async )?(?:function|const|class)\b)", re.MULTILINE)
_NAME: Final = re.compile(
    r"^(?:(?:async )?function\*? |const |let |class )(?P<name>[A-Za-z_$][\w$]*)", re.MULTILINE
)
_PATTERN: Final = re.compile(r"^(?:const|let) [\[{]", re.MULTILINE)


def joined(modules: Mapping[str, str]) -> str:
    """Join modules, each after those that it needs, into one script without imports and exports.

    Parameters
    ----------
    modules
        Source by path, such as ``"model/cycle.js"``.

    Raises
    ------
    KeyError
        If a module is missing.
    ValueError
        If there is a circle of imports, two modules use one name, or one declares several names by
        a pattern.
    """
    owners: dict[str, str] = {}
    parts = []
    needed = {path: _imports(path, source) for path, source in modules.items()}
    for path in TopologicalSorter(needed).static_order():
        text = _EXPORT.sub("", _IMPORT.sub("", modules[path]))
        if _PATTERN.search(text):
            raise ValueError(f"{path}: a pattern declares names; declare each by itself")
        for found in _NAME.finditer(text):
            other = owners.setdefault(found["name"], path)
            if other != path:
                raise ValueError(f"{path}: {found['name']} is a name of {other} too")
        parts.append(text)
    return "\n".join(parts)


def _imports(path: str, source: str) -> list[str]:
    folder = posixpath.dirname(path)
    paths = (found["path"] for found in _IMPORT.finditer(source))
    return [posixpath.normpath(posixpath.join(folder, each)) for each in paths]

"""The page's script: its modules joined into one, in the order in which they need each other.

A browser loads no modules from a file without a server, so the lines of import and export go and
the modules share one scope; a name that two of them use is refused.
"""

import posixpath
import re
from collections.abc import Mapping
from typing import Final

_IMPORT: Final = re.compile(r'^import \{[^}]*\} from "(?P<path>\.[^"]*)";\n', re.MULTILINE)
_EXPORT: Final = re.compile(r"^export (?=(?:function|const|class)\b)", re.MULTILINE)
_NAME: Final = re.compile(
    r"^(?:function\*? |const |let |class )(?P<name>[A-Za-z_$][\w$]*)", re.MULTILINE
)
_PATTERN: Final = re.compile(r"^(?:const|let) [\[{]", re.MULTILINE)


def joined(modules: Mapping[str, str], entry: str) -> str:
    """Join the modules that `entry` needs, itself last.

    Parameters
    ----------
    modules
        Source by path, such as ``"model/cycle.js"``.
    entry
        The path of the module that starts the page.

    Returns
    -------
    str
        One script without imports and exports.

    Raises
    ------
    ValueError
        If a module is missing, a circle of imports is found, two modules use one name, or one
        declares several names by a pattern.
    """
    owners: dict[str, str] = {}
    parts = []
    for path in _in_order(modules, entry):
        text = _EXPORT.sub("", _IMPORT.sub("", modules[path]))
        if _PATTERN.search(text):
            raise ValueError(f"{path}: a pattern declares names; declare each by itself")
        for found in _NAME.finditer(text):
            other = owners.setdefault(found["name"], path)
            if other != path:
                raise ValueError(f"{path}: {found['name']} is a name of {other} too")
        parts.append(text)
    return "\n".join(parts)


def imports(path: str, source: str) -> list[str]:
    """Return the paths of the modules that the one at `path` imports, relative to the page."""
    folder = posixpath.dirname(path)
    return [
        posixpath.normpath(posixpath.join(folder, found["path"]))
        for found in _IMPORT.finditer(source)
    ]


def _in_order(modules: Mapping[str, str], entry: str) -> list[str]:
    """Return the paths of what `entry` needs, each after those that it needs itself."""
    order: list[str] = []

    def visit(path: str, above: tuple[str, ...]) -> None:
        if path in above:
            raise ValueError(f"{path} imports itself by way of {above[-1]}")
        if path not in modules:
            raise ValueError(f"{above[-1] if above else 'the page'} needs {path}: no such module")
        if path not in order:
            for needed in imports(path, modules[path]):
                visit(needed, (*above, path))
            order.append(path)

    visit(entry, ())
    return order

"""Value references: the variable behind each, and functions that read lists of them.

An importer reads the same few lists of references at every step. Each list gets a function of its
own, compiled from one expression per variable.
"""

from typing import Any, Callable, Dict, List, Sequence, Tuple

from .model import Model, ModelError
from .table import Table, Variable

Reader = Callable[[Model], List[Any]]

_TYPES = ("Real", "Integer", "Boolean", "String")

# Lists of one type for which a function is kept: an importer may ask for any number of lists.
_MOST_READERS = 256


class References:
    """The variables of a table.

    Attributes
    ----------
    readers
        By type, the functions made so far, by list of references.
    """

    def __init__(self, table: Table) -> None:
        self._rows = table.rows
        self.readers: Dict[str, Dict[Tuple[int, ...], Reader]] = {kind: {} for kind in _TYPES}

    def variable(self, kind: str, reference: int) -> Variable:
        """Return the variable behind a value reference; raises ModelError where there is none."""
        if not 0 <= reference < len(self._rows):
            raise ModelError(f"there is no variable with value reference {reference}")
        variable = self._rows[reference]
        if variable.kind != kind:
            raise ModelError(f"{variable.name} is of type {variable.kind}, not {kind}")
        return variable

    def reader(self, kind: str, references: Tuple[int, ...]) -> Reader:
        """Return a function from a model to the values of these variables, refreshed if stale."""
        readers = self.readers[kind]
        read = readers.get(references)
        if read is None:
            attributes = [self.variable(kind, reference).attribute for reference in references]
            if len(readers) >= _MOST_READERS:
                readers.clear()
            read = readers[references] = _compiled(attributes)
        return read


def _compiled(attributes: Sequence[str]) -> Reader:
    """Return a function that reads these attributes of a model."""
    source = (
        "def read(model):\n"
        "    if model.stale:\n"
        "        model.refresh()\n"
        f"    return [{', '.join(f'model.{name}' for name in attributes)}]\n"
    )
    scope: Dict[str, Reader] = {}
    exec(compile(source, "<reader of values>", "exec"), scope)
    return scope["read"]

"""Value references: which variable of which type is behind one, and how a block is read by them."""

from operator import attrgetter
from typing import Any, Callable, Dict, Iterable, List, Sequence, Tuple

from .model import Block
from .settings import BlockError
from .variables import VARIABLES, Variable

# A simulator asks for the same few lists of variables again and again.
_MOST_READERS = 256

Reader = Callable[[Block], Sequence[Any]]


class References:
    """The variables as one FMI version types them.

    Parameters
    ----------
    types
        All types that calls may name.
    type_of
        Returns the type of a variable.

    Attributes
    ----------
    readers
        By type, the functions that were made for the lists of references asked for so far.
    """

    def __init__(self, types: Iterable[str], type_of: Callable[[Variable], str]) -> None:
        self._types = [type_of(variable) for variable in VARIABLES]
        self.readers: Dict[str, Dict[Tuple[int, ...], Reader]] = {each: {} for each in types}

    def variable(self, kind: str, reference: int) -> Variable:
        """Return the variable behind a value reference; raises BlockError where there is none."""
        if not 0 <= reference < len(VARIABLES):
            raise BlockError(f"there is no variable with value reference {reference}")
        variable = VARIABLES[reference]
        if self._types[reference] != kind:
            raise BlockError(f"{variable.name} is of type {self._types[reference]}, not {kind}")
        return variable

    def reader(self, kind: str, references: Tuple[int, ...]) -> Reader:
        """Return a function that reads the variables behind these references off a block."""
        readers = self.readers[kind]
        read = readers.get(references)
        if read is None:
            attributes = [self.variable(kind, reference).attribute for reference in references]
            if len(readers) >= _MOST_READERS:
                readers.clear()
            read = readers[references] = _read_all(attributes)
        return read


def _read_all(attributes: List[str]) -> Reader:
    """Return a function that reads these attributes."""
    if len(attributes) > 1:
        return attrgetter(*attributes)
    return lambda block: [attrgetter(name)(block) for name in attributes]

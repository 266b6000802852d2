"""Records: classes whose annotations name their fields, to be copied and written out."""

from typing import Any, Callable, ClassVar, Dict, Mapping, Tuple

from fmi.table import copier


class Record:
    """Base of a class whose annotations name its fields.

    `copy`, `save` and `restore` are made from the fields, so a new one is an annotation and a value
    in the constructor. A field holds a number, a tuple, or an object that is never changed: a copy
    shares it.
    """

    fields: ClassVar[Tuple[str, ...]] = ()

    # Returns a record with the same values.
    copy: ClassVar[Callable[[Any], Any]]

    def __init_subclass__(cls) -> None:
        cls.fields = tuple(cls.__annotations__)
        cls.copy = copier(cls, cls.fields)

    def save(self) -> Dict[str, Any]:
        """Return the fields by name as plain data: numbers, texts, lists and dictionaries."""
        return {name: plain(getattr(self, name)) for name in self.fields}

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Take up fields that `save` returned, lists as tuples."""
        for name, value in saved.items():
            setattr(self, name, tuple(value) if isinstance(value, list) else value)


def plain(value: Any) -> Any:
    """Return a tuple as a list, a record by name, and any other value as it is."""
    if isinstance(value, tuple):
        return [plain(part) for part in value]
    return value.save() if isinstance(value, Record) else value

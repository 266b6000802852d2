"""Records: classes whose fields are named once, in `__slots__`, to be copied and written out."""

from typing import Any, Callable, ClassVar, Dict, Mapping, Tuple


class Record:
    """Base of a class whose `__slots__` name its fields.

    `copy`, `save` and `restore` are made from the slots, so a new field is one name there and a
    value in the constructor. A field holds a number, a tuple, or an object that is never changed:
    a copy shares it.
    """

    __slots__: Tuple[str, ...] = ()

    # Returns a record with the same values.
    copy: ClassVar[Callable[[Any], Any]]

    def __init_subclass__(cls) -> None:
        # Written out field by field: a loop takes four times as long, and every state that a
        # simulator takes or sets is a copy.
        lines = ["def copy(self):", "    twin = new(kind)"]
        lines += [f"    twin.{name} = self.{name}" for name in cls.__slots__]
        made: Dict[str, Any] = {"new": object.__new__, "kind": cls}
        exec("\n".join([*lines, "    return twin"]), made)
        cls.copy = made["copy"]

    def save(self) -> Dict[str, Any]:
        """Return the fields by name as plain data: numbers, texts, lists and dictionaries."""
        return {name: plain(getattr(self, name)) for name in self.__slots__}

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Take up fields that `save` returned, lists as tuples."""
        for name, value in saved.items():
            setattr(self, name, tuple(value) if isinstance(value, list) else value)


def plain(value: Any) -> Any:
    """Return a tuple as a list, a record by name, and any other value as it is."""
    if isinstance(value, tuple):
        return [plain(each) for each in value]
    return value.save() if isinstance(value, Record) else value

"""The FMI 2.0 co-simulation face of a model, for pythonfmu's wrapper."""

from typing import Any, List

from pythonfmu import Fmi2Slave

from .instance import Instance, entry
from .model import Spec
from .readers import References

_TYPES = ("Real", "Integer", "Boolean", "String")


class Slave(Instance, Fmi2Slave):  # type: ignore[misc]
    """A model as a slave; a subclass names the model, ``class Packed(Slave, spec=SPEC)``."""

    # A % in a text would be taken for a directive.
    _log_is_printf = True

    def __init_subclass__(cls, spec: Spec, **arguments: Any) -> None:
        super().__init_subclass__(**arguments)
        cls._spec = spec
        cls._references = References(spec.table, _TYPES, lambda variable: variable.kind)
        # For a text that it cannot read the wrapper looks this up with an exception pending, and
        # then Python gives up at the first class that lacks it.
        cls.set_string = Instance.set_string  # type: ignore[method-assign]

    def __init__(self, **arguments: Any) -> None:
        arguments.setdefault("instance_name", "")
        super().__init__(**arguments)
        self.modelName = self._spec.name
        self._real_readers = self._references.readers["Real"]
        self._begin()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance the model by one communication step."""
        try:
            if not self._ready:
                self._prepare_step()
            self._model.advance(current_time, step_size)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None
        return True

    def get_real(self, vrs: List[int]) -> List[float]:
        """Return Real values by value reference."""
        # The call that simulators make most, so the common way is written out.
        try:
            if self._settled:
                read = self._real_readers.get(tuple(vrs))
                if read is not None:
                    return read(self._model)
            return self._read("Real", vrs)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None

    @entry
    def get_integer(self, vrs: List[int]) -> List[int]:
        """Return Integer values by value reference."""
        return self._read("Integer", vrs)

    @entry
    def set_real(self, vrs: List[int], values: List[float]) -> None:
        """Set Real parameters and inputs."""
        self._set("Real", vrs, values)

    @entry
    def set_integer(self, vrs: List[int], values: List[int]) -> None:
        """Set Integer parameters and inputs."""
        self._set("Integer", vrs, values)

"""The FMI 2.0 co-simulation face of the block, for pythonfmu's wrapper."""

from typing import Any, Dict, List, Optional

from pythonfmu import Fmi2Slave

from .face import Face, entry
from .references import References

_REFERENCES = References(("Real", "Integer", "Boolean", "String"), lambda variable: variable.kind)
_REAL_READERS = _REFERENCES.readers["Real"]


class StickSlip(Face, Fmi2Slave):  # type: ignore[misc]
    """The stick-slip block as a slave."""

    _references = _REFERENCES
    # A % in a text would be taken for a directive.
    _log_is_printf = True

    def __init__(self, **arguments: Any) -> None:
        arguments.setdefault("instance_name", "")
        super().__init__(**arguments)
        self.modelName = "StickSlip"
        self._begin()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance the block by one communication step."""
        try:
            if not self._ready:
                self._prepare_step()
            self._block.advance(current_time, step_size)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None
        return True

    def get_real(self, vrs: List[int]) -> List[float]:
        """Return Real values by value reference."""
        # The call that simulators make most, so the common way is written out.
        try:
            if self._settled:
                block = self._block
                if block.stale:
                    block.refresh()
                read = _REAL_READERS.get(tuple(vrs))
                if read is not None:
                    return list(read(block))
            return self._read("Real", vrs)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None

    @entry
    def get_integer(self, vrs: List[int]) -> List[int]:
        """Return Integer values by value reference."""
        return self._read("Integer", vrs)

    @entry
    def set_real(self, vrs: List[int], values: List[float]) -> None:
        """Set parameters and inputs; in a running simulation they act from the next step on."""
        self._set("Real", vrs, values)

    @entry
    def set_integer(self, vrs: List[int], values: List[int]) -> None:
        """Take nothing but start values before the start: no Integer is an input."""
        self._refuse_to_set("Integer", vrs, values)

    # For a text that it cannot read the wrapper looks this up with an exception pending, and then
    # Python gives up at the first class that lacks it.
    set_string = Face.set_string

    def to_xml(self, model_options: Optional[Dict[str, str]] = None) -> Any:
        """Return the model description, which the builder writes; the options are fixed."""
        import pythonfmu  # only a build asks, and an import of the whole builder is slow

        from .description import identity
        from .description2 import model_description

        package = __name__.partition(".")[0]
        return model_description(identity(package), f"pythonfmu {pythonfmu.__version__}")

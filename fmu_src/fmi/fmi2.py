"""The FMI 2.0 co-simulation face of a model, for pythonfmu's wrapper."""

from pythonfmu import Fmi2Slave

from .instance import Instance, getter, setter
from .table import Variable


class Slave(Instance, Fmi2Slave):  # type: ignore[misc]
    """A model as a slave."""

    _types = ("Real", "Integer", "Boolean", "String")
    # A % in a text would be taken for a directive.
    _log_is_printf = True

    @staticmethod
    def _type_of(variable: Variable) -> str:
        return variable.kind

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance the model by one communication step."""
        try:
            if not self._ready:
                self._prepare_step()
            self._model.advance(current_time, step_size)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None
        return True

    get_real, set_real = Instance.get_reals, setter("Real")
    get_integer, set_integer = getter("Integer"), setter("Integer")

"""The FMI 2.0 co-simulation face of the block, for pythonfmu's wrapper.

The wrapper turns every exception into a fatal status, and at each one gives away references that
it does not own (`lifetime`). So every method that it calls ends in a value, or in one `FmuError`
that `_fail` made.
"""

import contextlib
import functools
import json
import math
import sys
from operator import attrgetter
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple, TypeVar

from pythonfmu import Fmi2Slave

from .block import Block
from .lifetime import give_reference
from .meter import MOST_SLIPS
from .settings import BlockError, Settings
from .variables import VARIABLES, VARIABLES_BY_NAME, Variable, start_values

_WARNING = 1
_PHASES = ("instantiated", "initialization", "stepping", "terminated")
# A simulator asks for the same few lists of variables again and again.
_MOST_READERS = 256

_Method = TypeVar("_Method", bound=Callable[..., Any])
_Reader = Callable[[Block], Sequence[Any]]


class FmuError(Exception):
    """A call that failed; the text is for the user of the simulator."""


class LogMessage(NamedTuple):
    """What the wrapper reads off the log queue."""

    status: int
    category: str
    msg: str


def _entry(method: _Method) -> _Method:
    """Make a method safe to be called by the wrapper: refuse after a failure, fail in one way."""

    @functools.wraps(method)
    def guarded(self: "StickSlip", *arguments: Any) -> Any:
        try:
            if self._fault is not None:
                raise BlockError(self._fault)
            return method(self, *arguments)
        except BaseException as error:  # whatever it is, the importing process must survive it
            raise self._fail(error) from None

    return guarded  # type: ignore[return-value]


class StickSlip(Fmi2Slave):  # type: ignore[misc]
    """The stick-slip block as a slave."""

    def __init__(self, **arguments: Any) -> None:
        arguments.setdefault("instance_name", "")
        super().__init__(**arguments)
        self.modelName = "StickSlip"
        self.log_queue: List[LogMessage] = []
        self._settings = Settings(start_values())
        self._start_time = 0.0
        self._fault: Optional[str] = None
        self._phase = "instantiated"
        self._warned: Optional[Tuple[float, float]] = None
        # Whether a step may go straight to the block.
        self._ready = False
        self._block = Block(self._settings)
        # Whether the block shows what is set, and no call has failed.
        self._settled = True

    @_entry
    def setup_experiment(
        self,
        start_time: float,
        stop_time: Optional[float] = None,
        tolerance: Optional[float] = None,
    ) -> None:
        """Take the start time, which dates the events; the others mean nothing here."""
        if not abs(start_time) < float("inf"):
            raise BlockError(f"start time = {start_time!r} s is out of range: a finite number")
        self._require("instantiated", "setupExperiment")
        self._start_time = start_time
        self._settled = False

    @_entry
    def enter_initialization_mode(self) -> None:
        """Let the outputs follow what is set."""
        self._require("instantiated", "enterInitializationMode")
        self._phase = "initialization"

    @_entry
    def exit_initialization_mode(self) -> None:
        """Start the block from what was set; refuse values that do not go together."""
        self._require("initialization", "exitInitializationMode")
        self._block = Block(self._settings, self._start_time)
        self._settled = True
        self._phase = "stepping"
        self._warn_of_clamp()
        self._ready = True

    @_entry
    def terminate(self) -> None:
        """End the simulation; the outputs stay readable."""
        self._ready = False
        self._phase = "terminated"

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

    @_entry
    def get_integer(self, vrs: List[int]) -> List[int]:
        """Return Integer values by value reference."""
        return self._read("Integer", vrs)

    @_entry
    def get_boolean(self, vrs: List[int]) -> List[bool]:
        """Return Boolean values by value reference."""
        return self._read("Boolean", vrs)

    @_entry
    def get_string(self, vrs: List[int]) -> List[str]:
        """Refuse: there are no strings."""
        return self._read("String", vrs)

    @_entry
    def set_real(self, vrs: List[int], values: List[float]) -> None:
        """Set parameters and inputs; in a running simulation they act from the next step on."""
        stepping = self._phase == "stepping"
        for reference, value in zip(vrs, values):
            variable = self._settable("Real", reference, value)
            if variable.settable:
                setattr(self._settings, variable.name, value)
                if stepping:
                    self._block.set(variable.name, value)
        if stepping:
            self._settings.normal_force()
            # Only a step shows whether mu_s and mu_k stay as they are now.
            self._ready = False
        else:
            self._settled = False

    @_entry
    def set_integer(self, vrs: List[int], values: List[int]) -> None:
        """Take nothing but start values before the start: no Integer is an input."""
        self._refuse_to_set("Integer", vrs, values)

    @_entry
    def set_boolean(self, vrs: List[int], values: List[bool]) -> None:
        """Take nothing: no Boolean is an input."""
        self._refuse_to_set("Boolean", vrs, values)

    @_entry
    def set_string(self, vrs: List[int], values: List[str]) -> None:
        """Refuse: there are no strings."""
        self._refuse_to_set("String", vrs, values)

    @_entry
    def _get_fmu_state(self) -> Dict[str, Any]:
        return self._state()

    def _state(self) -> Dict[str, Any]:
        """Return everything that a later call depends on, as plain numbers, lists and texts."""
        return {
            "block": self._block.save(),
            "settings": self._settings.as_dict(),
            "start_time": self._start_time,
            "phase": self._phase,
            "settled": self._settled,
        }

    @_entry
    def _set_fmu_state(self, state: Dict[str, Any]) -> None:
        if not _is_state(state, self._state()):
            raise BlockError("the state to set is none that this FMU handed out")
        self._settings = Settings(state["settings"])
        self._start_time = state["start_time"]
        self._phase = state["phase"]
        self._settled = state["settled"]
        self._block.restore(state["block"])
        self._ready = False

    # The wrapper calls the next two without an instance and could not survive an exception.

    @staticmethod
    def _fmu_state_to_bytes(state: Any) -> bytes:
        try:
            return json.dumps(state).encode("utf-8")
        except Exception:
            return b"null"

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> Any:
        try:
            return json.loads(state.decode("utf-8"))
        except Exception:
            return None

    def to_xml(self, model_options: Optional[Dict[str, str]] = None) -> Any:
        """Return the model description, which the builder writes; the options are fixed."""
        import pythonfmu  # only a build asks, and an import of the whole builder is slow

        from .description import model_description

        digest = __name__.split(".")[0].rpartition("_")[2]
        return model_description(digest, f"pythonfmu {pythonfmu.__version__}")

    def _read(self, kind: str, vrs: List[int]) -> List[Any]:
        if self._fault is not None:
            raise BlockError(self._fault)
        if not self._settled:
            self._block = Block(self._settings, self._start_time)
            self._settled = True
        block = self._block
        if block.stale:
            block.refresh()
        return list(_reader(kind, tuple(vrs))(block))

    def _settable(self, kind: str, reference: int, value: float) -> Variable:
        """Return the variable that is to take `value`; raises BlockError where it cannot."""
        variable = _variable(kind, reference)
        objection = None
        if self._phase == "terminated":
            objection = f"{variable.name} cannot be set: the simulation is terminated"
        elif not variable.settable:
            # Before the start an importer may write back the start values that it read.
            if self._phase == "stepping" or variable.start is None or value != variable.start:
                objection = f"{variable.name} is an output: it cannot be set"
        elif self._phase == "stepping" and variable.variability == "fixed":
            if value != getattr(self._settings, variable.name):
                objection = f"{variable.name} is fixed: it cannot change after initialization"
        else:
            objection = variable.objection(value)
        if objection is not None:
            raise BlockError(objection)
        return variable

    def _refuse_to_set(self, kind: str, vrs: List[int], values: Sequence[Any]) -> None:
        for reference, value in zip(vrs, values):
            self._settable(kind, reference, value)

    def _prepare_step(self) -> None:
        """Do before a step what need not be done before each: refuse it, or warn."""
        if self._fault is not None:
            raise BlockError(self._fault)
        self._require("stepping", "doStep")
        self._warn_of_clamp()
        self._ready = True

    def _require(self, phase: str, call: str) -> None:
        if self._phase != phase:
            raise BlockError(f"{call} is not allowed here: the instance is in phase {self._phase}")

    def _warn_of_clamp(self) -> None:
        mu_s, mu_k = self._settings.mu_s, self._settings.mu_k
        if mu_k <= mu_s:
            self._warned = None
        elif self._warned != (mu_s, mu_k):
            self._warned = (mu_s, mu_k)
            text = (
                f"mu_k = {mu_k!r} is above mu_s = {mu_s!r}: "
                "mu_k is clamped to max(mu_s - 0.01, 0), see mu_k_used"
            )
            self.log_queue.append(LogMessage(_WARNING, "logStatusWarning", text))
            _tell(text)

    def _fail(self, error: BaseException) -> FmuError:
        """Return the exception that ends this call and, until a reset, every later one."""
        # One reference each for the wrapper to lose, before anything else can go wrong.
        for lost in (self, type(self), self.log_queue):
            give_reference(lost)
        if self._fault is None:
            known = isinstance(error, BlockError)
            self._fault = str(error) if known else f"internal error: {error!r}"
            _tell(self._fault)
        self._ready = self._settled = False
        # The wrapper hands it to the log, which is read as a printf format.
        return FmuError(self._fault.replace("%", "%%"))


_READERS: Dict[str, Dict[Tuple[int, ...], _Reader]] = {
    kind: {} for kind in ("Real", "Integer", "Boolean", "String")
}
_REAL_READERS = _READERS["Real"]


def _reader(kind: str, references: Tuple[int, ...]) -> _Reader:
    """Return a function that reads the variables behind these references off a block."""
    readers = _READERS[kind]
    read = readers.get(references)
    if read is None:
        attributes = [_variable(kind, reference).attribute for reference in references]
        if len(readers) >= _MOST_READERS:
            readers.clear()
        read = readers[references] = _read_all(attributes)
    return read


def _read_all(attributes: List[str]) -> _Reader:
    """Return a function that reads these attributes."""
    if len(attributes) > 1:
        return attrgetter(*attributes)
    return lambda block: [attrgetter(name)(block) for name in attributes]


def _variable(kind: str, reference: int) -> Variable:
    """Return the variable behind a value reference; raises BlockError where there is none."""
    if not 0 <= reference < len(VARIABLES):
        raise BlockError(f"there is no variable with value reference {reference}")
    variable = VARIABLES[reference]
    if variable.kind != kind:
        raise BlockError(f"{variable.name} is of type {variable.kind}, not {kind}")
    return variable


def _is_state(state: Any, own: Dict[str, Any]) -> bool:
    """Whether `state` can be one that was handed out; `own` is one that was."""
    if not _is_like(state, own):
        return False
    block = state["block"]
    mode, force = block["arc"][0], block["arc"][3]
    return (
        state["phase"] in _PHASES
        and mode in (-1, 0, 1)
        and (mode == 0 or force is not None)
        and block["elapsed"][0] >= 0.0
        and 0 <= block["meter"]["n_slips"] <= MOST_SLIPS
        and all(
            VARIABLES_BY_NAME[name].objection(value) is None
            for values in (state["settings"], block["settings"], block["wanted"])
            for name, value in values.items()
        )
    )


def _is_like(value: Any, pattern: Any, key: str = "") -> bool:
    """Whether a value has the structure and the types of another, and finite numbers."""
    if isinstance(pattern, dict):
        return (
            isinstance(value, dict)
            and value.keys() == pattern.keys()
            and all(_is_like(value[each], pattern[each], each) for each in pattern)
        )
    if key == "arc":
        # Its last entry is a force, or None where there is none.
        return _is_like(value, [0, 0.0, 0.0, 0.0]) or _is_like(value, [0, 0.0, 0.0, None])
    if isinstance(pattern, list):
        return (
            isinstance(value, list)
            and len(value) == len(pattern)
            and all(map(_is_like, value, pattern))
        )
    return type(value) is type(pattern) and (type(value) is not float or math.isfinite(value))


def _tell(text: str) -> None:
    """Write to standard error, where that can be done: many importers drop the log."""
    # A message that cannot be shown must not become a failure of its own.
    with contextlib.suppress(Exception):
        print(f"StickSlip: {text}", file=sys.stderr)

"""The protocol of a model, its error, and the specification that an FMU is made of."""

from typing import TYPE_CHECKING, Any, Dict, Mapping, NamedTuple, Optional, Protocol, Tuple, Type

from .table import Table, Values


class ModelError(ValueError):
    """Values, a step or a state that the model cannot take; the text says which, and the range."""


class Model(Protocol):
    """A model that an FMU runs.

    A class that derives from this one may leave out `refresh`, `check` and `warning`.

    Parameters
    ----------
    values
        Parameters, inputs and start values.
    start_time
        Time at the start [s].

    Attributes
    ----------
    wanted
        The values as last set.
    stale
        Whether outputs that are attributes have to be computed by `refresh` before they are read.

    Notes
    -----
    **Contract of an implementer**

    A model must guarantee:

    1. **Construction.** A model is made from values that are within their ranges one by one, and
       shows the outputs of its initial state. It raises `ModelError` for values that do not go
       together. Until the end of the initialization a new one is made after a value was set,
       so the constructor has no effects outside the model.
    2. **Outputs.** The value of a row is found under the row's `attribute`, a float, int or bool
       of its kind. Where `stale` is true, `refresh` is called before any is read. Reading
       an attribute changes nothing. Both may raise `ModelError`, for a value that is not finite.
    3. **Values.** `set` replaces `wanted` by a changed copy and does nothing that an output shows.
       The value acts from the start of the next step. Parameters of variability ``fixed`` keep
       their values.
    4. **Steps.** `advance` moves on by a step of any length above 0 and raises `ModelError` for
       any other. A model whose call raised gets no further call.
    5. **States.** `freeze` returns the whole state, `wanted` included, as an object that is never
       written to again; `thaw` takes it up, in this model or another one of the class, and what
       follows is the same to the bit. Both are called at every step of an iterating simulator.
    6. **Bytes.** `save` returns the same state as dictionaries and lists of finite numbers, truth
       values, texts and None; `restore` takes it up, and raises `ModelError` for anything that
       `save` cannot have returned: `plain.check` compares structure and types, `plain.values`
       reads a record of values.
    7. **Errors.** `ModelError` is for the user of the simulator: its text names variable, value,
       unit and range. Any other exception is reported as an internal error.

    A model may assume:

    8. Every value that is set is a finite number within the bounds of its row.
    9. The time of a step is a float, but may be infinite or NaN; steps need not join up.
    10. No two calls of one model overlap.

    A model must leave alone:

    11. Standard output, standard error, the log, files, threads and global state: a message
        for the user is raised, or returned by `warning`.
    12. Everything but Python's standard library, at version 3.8; a model that is packed brings the
        modules along that it imports.
    """

    stale: bool = False

    # A class holds it as an attribute or as a property.
    if TYPE_CHECKING:

        @property
        def wanted(self) -> Any:
            """The values as last set."""

    def __init__(self, values: Any, start_time: float = 0.0) -> None: ...

    def set(self, name: str, value: float) -> None:
        """Set an input or a tunable parameter; it acts from the start of the next step."""

    def advance(self, time: float, step: float) -> None:
        """Move on by one communication step, of length `step` [s] from `time` [s] on.

        Raises ModelError if the model cannot follow the step or the values set.
        """

    def refresh(self) -> None:
        """Compute the outputs where the model stands, and clear `stale`."""
        self.stale = False

    def check(self) -> None:
        """Raise ModelError if the values in `wanted` do not go together."""
        return

    def warning(self) -> Optional[str]:
        """Return a warning about the values in `wanted`, or None.

        The simulator is told at the end of the initialization and before the first step after a
        value was set, once for each text.
        """
        return None

    def freeze(self) -> Any:
        """Return the whole state for `thaw`."""

    def thaw(self, frozen: Any) -> None:
        """Take up a state that `freeze` returned."""

    def save(self) -> Dict[str, Any]:
        """Return the whole state as plain data for `restore`."""

    def restore(self, saved: Any) -> None:
        """Take up a state that `save` returned; raises ModelError for anything else."""


class Experiment(NamedTuple):
    """Default experiment: start time, stop time and step size [s], None for no default."""

    start_time: float = 0.0
    stop_time: Optional[float] = None
    step_size: Optional[float] = None


class Annotation(NamedTuple):
    """An annotation of the model: one XML element, for tools that know its type.

    Attributes
    ----------
    type
        Reverse domain name, such as org.example.units: the type in FMI 3.0, the tool in FMI 2.0.
    element
        Name of the element.
    attributes
        Attributes of the element.
    """

    type: str
    element: str
    attributes: Mapping[str, str]


class Spec(NamedTuple):
    """A model with everything that its description says.

    Attributes
    ----------
    name
        Name and identifier of the model: a Python identifier.
    description
        One or two sentences on the model.
    author, licence
        Names.
    version
        Of the model.
    date
        Of the version, as 2026-01-31T00:00:00Z; see `description.generation_time`.
    values
        The record of values, which holds the table.
    model
        The class of the model.
    experiment
        Default experiment.
    annotations
        Annotations of the model.
    """

    name: str
    description: str
    author: str
    version: str
    date: str
    licence: str
    values: Type[Values]
    model: Type[Model]
    experiment: Experiment = Experiment()
    annotations: Tuple[Annotation, ...] = ()

    @property
    def table(self) -> Table:
        """The table of variables."""
        return self.values.table

    def start(self) -> Model:
        """Return a model at the start values of the table."""
        return self.model(self.values.at_start())

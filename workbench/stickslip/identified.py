"""What a record of a drive or a pull test tells of an axis, from Python; as `stickslip.library`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.files import write
from stickslip.results import Shown
from stickslip.show.tables import identified_summary
from stickslip_design.axis import AxisFile, AxisSource, read_axis_file
from stickslip_design.identify import plots, report, study
from stickslip_design.identify.axis_text import axis_of, written
from stickslip_design.identify.model import Floats, Identified
from stickslip_design.identify.read import read_record, record_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType


@dataclass(frozen=True, repr=False)
class Identification(Shown):
    """What a record tells: `found` has all figures, `source` is its name, `file` the axis."""

    found: Identified
    source: str
    file: AxisFile | None = None

    def __repr__(self) -> str:
        known = ", ".join(each.name for each in self.found.numbers if each.identified) or "nothing"
        return f"<Identification of {self.source}, {self.found.kind}: {known}>"

    @cached_property
    def axis_text(self) -> str:
        """The axis file with the numbers that the record tells, each with its ±."""
        return written(self.found, self.file, self.source)

    @cached_property
    def sentence(self) -> str:
        """What the axis does with these numbers, and what ends that; or what is missing."""
        name, folder = (self.file.name, self.file.folder) if self.file else ("axis.toml", None)
        said = report.sentence(self.axis_text, name, folder)
        return f"{said}{' But the model does not explain the record.' * (not self.found.explained)}"

    def table(self) -> RenderableType:
        """Return the summary, for rich."""
        return identified_summary(self.found, self.source, self.sentence)

    def to_dict(self) -> dict[str, Any]:
        """Return numbers, intervals and findings [SI] as JSON knows them, without the samples."""
        return report.data(self.found, self.source, self.sentence)

    def html(self) -> str:
        """Return the report as a page that asks for nothing outside itself."""
        return report.html(self.found, self.source, self.sentence)

    def plot(self) -> Figure:
        """Draw the record with its parts, the fit over it, and what the fit leaves."""
        return plots.courses(self.found)

    def report(self, file: Path | str) -> Path:
        """Write the report, and return its path."""
        write(Path(file), self.html().encode(), "file")
        return Path(file)

    def write(self, file: Path | str) -> Path:
        """Write `axis_text` as a file for `design`, and return its path."""
        write(Path(file), self.axis_text.encode(), "file")
        return Path(file)


def identify(
    record: Path | str | Mapping[str, Floats],
    axis: AxisSource | None = None,
    columns: Mapping[str, str] | None = None,
) -> Identification:
    """Return what a record of a drive or a pull test tells of its axis, each number with its 95 %.

    Parameters
    ----------
    record
        A CSV file, docs/identify.md; or columns [SI], each of shape (n,), by name: ``t``,
        ``position``, ``command``, ``velocity``, ``force``.
    axis
        The axis, as of `design`, whose friction may be missing. None: a rigid drive, of which
        nothing is known.
    columns
        Names of columns with the unit that a header lacks, by quantity
        (``{"position": "x [mm]"}``); others are guessed.

    Raises
    ------
    ValueError
        If record or axis cannot be used, in one line.
    """
    file = None if axis is None else read_axis_file(axis)
    known = None if file is None else axis_of(file)
    if isinstance(record, Mapping):
        source, samples = "the record", record_of(record, known)
    else:
        source, samples = Path(record).name, read_record(record, columns, known)
    drive = known.drive if known else None
    try:
        found = study.identify(samples, known)
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from None
    return Identification(report.scaled(found, samples.force_spread, drive), source, file)

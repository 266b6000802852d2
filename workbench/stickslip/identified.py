"""What a record of a drive or a pull test tells of an axis, from Python; as `stickslip.library`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from rich.console import RenderableType

from stickslip.files import write
from stickslip.results import Shown
from stickslip.show.tables import identified_summary
from stickslip_design.axis import AxisFile, AxisSource, read_axis_file
from stickslip_design.identify import report, study
from stickslip_design.identify.axis_text import axis_of, written
from stickslip_design.identify.model import Floats, Identified
from stickslip_design.identify.read import read_record
from stickslip_design.report.page import drawn, plain, rendered


@dataclass(frozen=True, repr=False)
class Identification(Shown):
    """What a record tells, `found`, and an `axis` file with its numbers, for `design`."""

    found: Identified
    source: str
    axis: AxisFile

    def __repr__(self) -> str:
        return f"<Identification of {self.source}: {self.found.kind}>"

    @cached_property
    def sentence(self) -> str:
        """What the axis does with these numbers, and what ends that; or what is missing."""
        doubt = "" if self.found.explained else " But the model does not explain the record."
        return report.sentence(self.axis) + doubt

    def table(self) -> RenderableType:
        """Return the summary, for rich."""
        return identified_summary(self.found, self.source, self.sentence)

    def to_dict(self) -> dict[str, Any]:
        """Return numbers, intervals and findings [SI] as JSON knows them, without the samples."""
        known = [each.name for each in self.found.numbers if each.identified]
        said = {"format": 1, "record": self.source, "sentence": self.sentence, "known": known}
        return {**said, **plain(replace(self.found, traces=()))}

    def html(self) -> str:
        """Return the report as a page that asks for nothing outside itself."""
        return rendered("identified.html.j2", said=self, report=report, drawn=drawn)

    def plot(self) -> Figure:
        """Draw the record with its parts, the fit over it, and what the fit leaves."""
        return report.picture(self.found.traces, self.found.segments)

    def report(self, file: Path | str) -> Path:
        """Write the report, and return its path."""
        write(Path(file), self.html().encode(), "file")
        return Path(file)


def identify(
    record: Path | str | Mapping[str, Floats],
    axis: AxisSource | None = None,
    columns: Mapping[str, str] | None = None,
) -> Identification:
    """Return what a record of a drive or a pull test tells of its axis, each number with its 95 %.

    Parameters
    ----------
    record, columns
        A CSV file, and names of its columns where they are not guessed
        (``{"position": "x [mm]"}``): docs/identify.md. Or arrays [SI], each of shape (n,), by name:
        ``t``, ``position``, ``command``, ``velocity``, ``force``.
    axis
        The axis, as of `design`, whose friction may be missing. None: a rigid drive, of which
        nothing is known.

    Raises
    ------
    ValueError
        If record or axis cannot be used, in one line.
    """
    file = read_axis_file(axis or {})
    known = axis_of(file) if axis else None
    source = "the record" if isinstance(record, Mapping) else Path(record).name
    samples = read_record(record, columns, known)
    try:
        found = study.identify(samples, known)
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from None
    return Identification(found, source, written(found, file, source))

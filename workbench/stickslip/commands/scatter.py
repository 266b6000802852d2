"""`stickslip scatter`: how likely an axis jumps where its numbers vary."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from stickslip.commands.expanded import Computing, command
from stickslip.errors import CommandError

if TYPE_CHECKING:
    from stickslip_design.tolerances.study import Scatter


@command
def scatter(
    axis: Path,
    *,
    vary: Mapping[str, str],
    spread_is: Literal["uniform", "normal"] = "uniform",
    correlation: Mapping[str, str],
    feed: list[str] | None = None,
    samples: int | None = None,
    indices: int | None = None,
    seed: int = 0,
    hold: str | None = None,
    solve: str | None = None,
    within: str | None = None,
    output: Path | None = None,
    computing: Computing,
) -> None:
    """Tell how likely an axis jumps at a feed where its numbers vary, and by how much."""
    from stickslip.commands.shared import computed
    from stickslip_design.axis import read_axis_file
    from stickslip_design.chunks import Results, Study
    from stickslip_design.datasets import need
    from stickslip_design.tolerances.study import answer, question
    from stickslip_design.tolerances.words import sentences

    asked = question(
        read_axis_file(axis), vary=vary, spread_is=spread_is,
        correlation=_correlations(correlation), feeds=feed or (), samples=samples,
        indices=indices, seed=seed, hold=hold, solve=solve, within=within,
    )  # fmt: skip
    if output is not None:
        for module in ("xarray", "pandas", "pyarrow"):
            need(module)

    def compute(study: Study, name: str) -> Results:
        folder = None if output is None else str(output / "chunks" / name)
        return computed(study, folder, computing, _DESCRIBED[name])

    found = answer(asked, compute)
    for sentence in sentences(found):
        print(sentence)
    if output is not None:
        print("written:", ", ".join(_write(found, output)))


_DESCRIBED = {
    "samples": "Machines",
    "indices": "Sobol indices",
    "turns": "Where machines turn",
    "solved": "The answer, counted anew",
    "now": "The machines as they are",
}
"""What is computed in each folder of chunks."""


def _correlations(typed: Mapping[str, str]) -> dict[tuple[str, str], float]:
    found: dict[tuple[str, str], float] = {}
    for names, value in typed.items():
        one, comma, other = (part.strip() for part in names.partition(","))
        if not (one and comma and other):
            raise CommandError(f"--correlation {names}={value}: write NAME,NAME=VALUE")
        try:
            found[one, other] = float(value)
        except ValueError:
            message = f"--correlation {names}={value}: {value} is no number from -1 to 1"
            raise CommandError(message) from None
    return found


def _write(found: "Scatter", folder: Path) -> list[str]:
    """Write page, pictures, machines and summary; return their names."""
    import io
    from json import dumps

    from stickslip.files import write
    from stickslip_design.datasets import write_points
    from stickslip_design.tolerances.page import data, html, picture

    text = dumps(data(found), ensure_ascii=False, allow_nan=False, indent=1)
    image, table = io.BytesIO(), folder / "machines.parquet"
    if (drawn := picture(found)) is not None:
        drawn.savefig(image, format="png", dpi=150)
    contents = {
        "scatter.html": html(found).encode(),
        "scatter.png": image.getvalue(),
        "scatter.json": f"{text}\n".encode(),
    }
    for name, content in contents.items():
        write(folder / name, content, "--output")
    partial = table.with_suffix(".part")
    write_points(found.table(), partial)
    partial.replace(table)
    return [str(folder / name) for name in (*contents, table.name)]

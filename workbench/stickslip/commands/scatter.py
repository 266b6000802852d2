"""`stickslip scatter`: how likely an axis jumps where its numbers vary."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from stickslip.commands.expanded import Computing, arg, command, opt
from stickslip.errors import CommandError

if TYPE_CHECKING:
    from stickslip_design.tolerances.study import Scatter


@command
def scatter(
    *,
    axis: Annotated[Path, arg("The axis file; its ± count as scatter.", "AXIS.toml")],
    vary: Annotated[
        Mapping[str, str],
        opt(
            "How a number varies, such as 'friction.mu_s=normal 0.2 0.02' (mean, sigma), "
            "lognormal (median, sigma), uniform LOW..HIGH, triangular LOW LIKELIEST HIGH, ± 10 %, "
            "or fixed; may be repeated.",
            "'NAME=DISTRIBUTION'",
        ),
    ],
    spread_is: Annotated[
        Literal["uniform", "normal"],
        opt("What a ± means: any value within it alike, or two sigma of a normal."),
    ] = "uniform",
    correlation: Annotated[
        Mapping[str, str],
        opt(
            "Correlation of two numbers that vary, -1 to 1, such as "
            "friction.mu_s,friction.mu_k=0.8; may be repeated.",
            "NAME,NAME=VALUE",
        ),
    ],
    feed: Annotated[
        list[str] | None,
        opt(
            "Feed to judge at, such as '2 mm/min'; may be repeated. Default: those of the file.",
            "VALUE",
        ),
    ] = None,
    samples: Annotated[
        int | None,
        opt("Machines drawn; default: 100000 where closed forms answer, else 1000.", "N", min=1),
    ] = None,
    indices: Annotated[
        int | None,
        opt(
            "Rows of the Sobol indices, a power of two, each as many points as numbers vary "
            "and two; 0: none. Default: 4096 where closed forms answer, else 0.",
            "ROWS",
            min=0,
        ),
    ] = None,
    seed: Annotated[int, opt("Seed of the random numbers.", "N", min=0)] = 0,
    hold: Annotated[
        str | None,
        opt(
            "What must hold, such as '99 % at 2 mm/min': so many machines run evenly there.",
            "'SHARE at FEED'",
        ),
    ] = None,
    solve: Annotated[
        str | None, opt("The number whose nominal value is solved for, with --hold.", "NAME")
    ] = None,
    within: Annotated[
        str | None,
        opt(
            "Where it is looked for; default: a tenth to ten times the nominal value.",
            "'LOW..HIGH UNIT'",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        opt(
            "Folder of page, pictures, machines and summary; a study that was ended resumes there.",
            "FOLDER",
            "-o",
            "--output",
        ),
    ] = None,
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

    image, table = io.BytesIO(), folder / "machines.parquet"
    if (drawn := picture(found)) is not None:
        drawn.savefig(image, format="png", dpi=150)
    contents = {
        "scatter.html": html(found).encode(),
        "scatter.png": image.getvalue(),
        "scatter.json": (
            dumps(data(found), ensure_ascii=False, allow_nan=False, indent=1) + "\n"
        ).encode(),
    }
    for name, content in contents.items():
        write(folder / name, content, "--output")
    partial = table.with_suffix(".part")
    write_points(found.table(), partial)
    partial.replace(table)
    return [str(folder / name) for name in (*contents, table.name)]

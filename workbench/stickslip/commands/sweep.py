"""`stickslip sweep`: an FMU or a system of FMUs run with many settings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stickslip.commands.expanded import command
from stickslip.commands.options import Computing
from stickslip.commands.running import computed as run
from stickslip.commands.shared import console, hand_out, say
from stickslip.errors import CommandError


@command
def sweep(
    *,
    model: Annotated[
        Path, typer.Argument(metavar="MODEL", help="The FMU or SSP file.", show_default=False)
    ],
    plan: Annotated[
        Path | None,
        typer.Argument(
            metavar="PLAN.toml",
            help="What to set, how long to run and what to keep; with --template the new file to "
            "write, else it prints.",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FOLDER",
            help="Where the results go, a folder or an address of fsspec: sweep.zarr of a grid, "
            "sweep.parquet of points, and chunk files from which a killed sweep resumes.",
            show_default=False,
        ),
    ] = None,
    template: Annotated[
        bool, typer.Option("--template", help="Write a plan with the model's own variables.")
    ] = False,
    computing: Computing,
) -> None:
    """Run an FMU or SSP file with many settings, and keep numbers of each run."""
    if template:
        from stickslip_design.sweeps import read_model
        from stickslip_design.sweeps.template import template as template_text

        hand_out(template_text(read_model(model)), plan, "--template")
        return
    if plan is None:
        raise CommandError(
            "no plan is named; stickslip sweep MODEL --template plan.toml writes one to begin with"
        )
    from stickslip.show.sweep_summary import sweep_summary
    from stickslip_design.sweeps.study import computed, file_of, prepare

    study = prepare(model, plan)
    found = computed(
        study,
        output,
        lambda ready, chunks: run(ready, chunks, described="Sweeping", **vars(computing)),
    )
    console().print(sweep_summary(found))
    if output is not None:
        say(f"written: {output}/{file_of(study)}")

"""`stickslip sweep`: an FMU or a system of FMUs run with many settings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from stickslip.commands.expanded import Computing, arg, command, opt
from stickslip.commands.shared import computed as run
from stickslip.commands.shared import console, hand_out, say
from stickslip.errors import CommandError


@command
def sweep(
    *,
    model: Annotated[Path, arg("The FMU or SSP file.", "MODEL")],
    plan: Annotated[
        Path | None,
        arg(
            "What to set, how long to run and what to keep; with --template the new file to "
            "write, else it prints.",
            "PLAN.toml",
        ),
    ] = None,
    output: Annotated[
        str | None,
        opt(
            "Where the results go, a folder or an address of fsspec: sweep.zarr of a grid, "
            "sweep.parquet of points, and chunk files from which a killed sweep resumes.",
            "FOLDER",
            "-o",
            "--output",
        ),
    ] = None,
    template: Annotated[bool, opt("Write a plan with the model's own variables.")] = False,
    computing: Computing,
) -> None:
    """Run an FMU or SSP file with many settings, and keep numbers of each run."""
    if template:
        from stickslip_design.sweeps import read_model
        from stickslip_design.sweeps.plan import template as template_text

        hand_out(template_text(read_model(model)), plan, "--template")
        return
    if plan is None:
        raise CommandError(
            "no plan is named; stickslip sweep MODEL --template plan.toml writes one to begin with"
        )
    from stickslip.show.tables import sweep_summary
    from stickslip_design.sweeps.study import computed, file_of, prepare

    study = prepare(model, plan)
    found = computed(study, output, lambda ready, place: run(ready, place, computing, "Sweeping"))
    console().print(sweep_summary(found))
    if output is not None:
        say(f"written: {output}/{file_of(study)}")

"""`stickslip sweep`: an FMU or a system of FMUs run with many settings."""

from __future__ import annotations

from pathlib import Path

from stickslip.commands.expanded import Computing, command
from stickslip.commands.shared import computed as run
from stickslip.commands.shared import console, hand_out, say
from stickslip.errors import CommandError


@command
def sweep(
    model: Path,
    plan: Path | None = None,
    *,
    output: str | None = None,
    template: bool = False,
    computing: Computing,
) -> None:
    """Run an FMU or SSP file with many settings, and keep numbers of each run."""
    if template:
        from stickslip_design.sweeps.model import read_model
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

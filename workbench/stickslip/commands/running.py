"""Studies of many points as commands run them: checked, shown on their way, ended in one line."""

from typing import TYPE_CHECKING

from stickslip.commands.shared import say
from stickslip.errors import CommandError

if TYPE_CHECKING:
    from stickslip_design.chunks import Progress, Results, Study

MOST_POINTS = 10**9
"""Points that are computed without --yes."""


def computed(
    study: "Study",
    folder: str | None,
    *,
    described: str,
    workers: int | None = None,
    cluster: str | None = None,
    fresh: bool = False,
    yes: bool = False,
) -> "Results":
    """Compute a study, and show its rate, the time left and its failures on a terminal.

    Parameters
    ----------
    study
        What to compute.
    folder
        The folder or address where it resumes; None: it does not.
    described
        What is done, as progress shows it: "Computing the map".
    workers, cluster, fresh, yes
        The options of these names.

    Raises
    ------
    CommandError
        If an option is wrong, or the study cannot be computed to its end.
    """
    from stickslip.progress import Meter
    from stickslip_design.chunks import StudyError, run

    if workers is not None and workers < 1:
        raise CommandError(f"--workers {workers}: at least 1 is needed")
    if workers is not None and cluster is not None:
        raise CommandError("--workers goes with this machine, not with --cluster")
    if study.count > MOST_POINTS and not yes:
        raise CommandError(f"{study.count:.4g} points are more than 10^9; --yes computes them")
    said = set[str]()
    with Meter(described) as meter:

        def show(progress: "Progress") -> None:
            if progress.note and progress.note not in said:
                said.add(progress.note)
                say(progress.note)
            meter.advance(progress.done, progress.count, f"{described}: {_how_far(progress)}")

        try:
            return run(study, folder, workers=workers, cluster=cluster, fresh=fresh, progress=show)
        except StudyError as error:
            raise CommandError(str(error)) from error


def _how_far(progress: "Progress") -> str:
    """Return points, rate and failures in words."""
    words = [
        f"{progress.done:,} of {progress.count:,} points".replace(",", "\N{NARROW NO-BREAK SPACE}")
    ]
    if progress.seconds > 0.0:
        words.append(f"{(progress.done - progress.kept) / progress.seconds:.3g}/s")
    if progress.failed:
        words.append(f"{progress.failed} without a result")
    return ", ".join(words)

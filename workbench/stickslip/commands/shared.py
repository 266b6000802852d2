"""What the commands share: the console, a line on standard error, the FMU of a run, studies."""

import contextlib
import io
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.commands.expanded import Computing
from stickslip.errors import CommandError

if TYPE_CHECKING:
    from rich.console import Console

    from stickslip_design.chunks import Progress, Results, Study
    from stickslip_verification import Verdict

BUILD_FOLDER = Path("build")

COULOMB = "coulomb"
"""The name of the friction law of the default FMU."""


def say(text: str) -> None:
    """Tell the person something that is not the result: one line on standard error."""
    print(f"stickslip: {' '.join(text.split())}", file=sys.stderr)


def console() -> "Console":
    """Return the console that results go to."""
    from rich.console import Console

    # A pipe has no width of its own, and a table for a program or a log should not be folded.
    width = None if sys.stdout.isatty() else 200
    return Console(width=width, markup=False, highlight=False)


def built(target: Path, option: str, **options: Any) -> Path:
    """Build the FMU into a file or a folder, which `option` named; `CommandError` if it cannot.

    The options are those of `library.build`.
    """
    from stickslip.files import check_writable, refused
    from stickslip.library import build
    from stickslip.progress import meter

    if target.suffix in (".fmu", ".ssp") and target.parent.is_dir():
        check_writable(target, option)
    with meter("Building the FMU"), refused(target, option, "write the FMU"):
        return build(target, **options)


def current_fmu(law: str = COULOMB) -> Path:
    """Build the FMU anew where `stickslip build` puts it, unless it is there as it would be built.

    What is there may carry evidence, which a bare one would take away.
    """
    import tempfile

    from stickslip.files import make_folder, write
    from stickslip_verification.drive.description import content_digest

    with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
        fresh = built(Path(folder), "--fmu", law=law, **_native(law))
        there = BUILD_FOLDER / fresh.name
        with contextlib.suppress(OSError, zipfile.BadZipFile):
            if content_digest(there) == content_digest(fresh):
                return there
        make_folder(BUILD_FOLDER, "--fmu")
        write(there, fresh.read_bytes(), "--fmu")
    return there


def _native(law: str) -> dict[str, bool]:
    """Return the options of a build of a law that is native alone, for this machine."""
    from stickslip_fmu.laws.named import friction_law
    from stickslip_fmu.laws.native_only import NativeOnly
    from stickslip_native.library import this_machine

    if not isinstance(friction_law(law).law, NativeOnly):
        return {}
    return {"native": True, "this_machine": this_machine()}


def tell_of(fmu: Path) -> None:
    """Print where an FMU is, its size and its SHA-256."""
    import hashlib

    content = fmu.read_bytes()
    print(f"{fmu}  {len(content)} bytes  SHA-256 {hashlib.sha256(content).hexdigest()}")


def pack_evidence(fmu: Path, verdict: "Verdict", option: str) -> None:
    """Put the evidence into the FMU that was judged, which `option` named."""
    from fmi.packer import add
    from stickslip.files import refused
    from stickslip.handbook.evidence import evidence
    from stickslip_verification.drive.description import content_digest
    from stickslip_verification.drive.instance import FmuFile
    from stickslip_verification.drive.masters import law_of

    if content_digest(fmu) != verdict.provenance["fmu"]["content"]:
        raise CommandError(f"{option} {fmu}: it changed while it was judged: nothing is packed")
    file = FmuFile(fmu)
    law = law_of(file)
    file.close()
    with refused(fmu, option, "write the FMU"):
        add(fmu, evidence(fmu, verdict, law))


def hand_out(text: str, target: Path | None, option: str, then: str = "") -> None:
    """Print a text to begin with, or write it where no file is yet; `then` is what comes next."""
    from stickslip.files import write

    if target is None:
        print(text, end="")
        return
    if target.exists():
        raise CommandError(f"{option} {target}: there is such a file already; name a new one")
    write(target, text.encode(), option)
    print(f"written: {target}{then}")


@contextlib.contextmanager
def long_work(what: str) -> Iterator[Callable[[str, int, int], None]]:
    """Show the progress of long work that is done in other processes."""
    from stickslip.progress import meter

    # What an FMU warns of belongs to its cases; on the terminal it would cut the progress.
    with meter(what) as advance, contextlib.redirect_stderr(io.StringIO()):
        yield lambda now, done, total: advance(done, total or None, now)


MOST_POINTS = 10**9
"""Points that are computed without --yes."""


def computed(study: "Study", folder: str | None, computing: Computing, described: str) -> "Results":
    """Compute a study, and show its rate, the time left and its failures on a terminal.

    It resumes in `folder`, a folder or an address, if that is not None; `described` is what is
    done, as progress shows it: "Computing the map". `CommandError` if options do not go together,
    `StudyError` if the study cannot be computed to its end.
    """
    from stickslip.progress import meter
    from stickslip_design.chunks import run

    workers, cluster, fresh = computing.workers, computing.cluster, computing.fresh
    if workers is not None and cluster is not None:
        raise CommandError("--workers goes with this machine, not with --cluster")
    if study.count > MOST_POINTS and not computing.yes:
        raise CommandError(f"{study.count:.4g} points are more than 10^9; --yes computes them")
    said = set[str]()
    with meter(described) as advance:

        def show(progress: "Progress") -> None:
            if progress.note and progress.note not in said:
                said.add(progress.note)
                say(progress.note)
            advance(progress.done, progress.count, f"{described}: {_how_far(progress)}")

        return run(study, folder, workers=workers, cluster=cluster, fresh=fresh, progress=show)


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

"""`stickslip page` and `stickslip explore`: the interactive page, as a file and in the browser."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.commands.options import (
    Damping,
    Gravity,
    KineticFriction,
    Load,
    Mass,
    PullingVelocity,
    StaticFriction,
    Stiffness,
)
from stickslip.commands.quantities import option_name, read_values
from stickslip.commands.shared import say
from stickslip.errors import CommandError

DEFAULT_PAGE = Path("stick-slip.html")


def page(
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FILE", help="File to write.")
    ] = DEFAULT_PAGE,
    m: Mass = None,
    g: Gravity = None,
    k: Stiffness = None,
    c: Damping = None,
    mu_s: StaticFriction = None,
    mu_k: KineticFriction = None,
    v: PullingVelocity = None,
    load: Load = None,
) -> None:
    """Write the interactive page: one HTML file that works without a network."""
    text = _page({"m": m, "g": g, "k": k, "c": c, "mu_s": mu_s, "mu_k": mu_k, "v": v, "load": load})
    _write(text, output)
    print(f"{output}  {len(text.encode())} bytes")


def explore(
    m: Mass = None,
    g: Gravity = None,
    k: Stiffness = None,
    c: Damping = None,
    mu_s: StaticFriction = None,
    mu_k: KineticFriction = None,
    v: PullingVelocity = None,
    load: Load = None,
) -> None:
    """Open the interactive page in the browser: drag a slider, see it stick and slip."""
    import tempfile
    import webbrowser

    text = _page({"m": m, "g": g, "k": k, "c": c, "mu_s": mu_s, "mu_k": mu_k, "v": v, "load": load})
    # The browser reads it after this process has ended, so it stays.
    file = Path(tempfile.mkdtemp(prefix="stickslip-")) / DEFAULT_PAGE
    _write(text, file)
    print(file)
    if not webbrowser.open(file.as_uri()):
        say("no browser could be started: open that file in one")
        raise typer.Exit(1)


def _page(typed: dict[str, str | None]) -> str:
    """Assemble the page that begins with the values typed, or with the FMU's start values."""
    from stickslip.page import page as assemble
    from stickslip.page import page_range

    values = read_values(typed)
    for name, text in typed.items():
        low, high, unit = page_range(name)
        if text is not None and not low <= values[name] <= high:
            raise CommandError(
                f"{option_name(name)} {text!r}: the page shows {low:g} to {high:g} {unit}".rstrip()
            )
    weight = values["m"] * values["g"]
    if weight + values["load"] < 0.0:
        raise CommandError(
            f"{option_name('load')} {typed['load']!r} would lift the mass of {weight:g} N"
        )
    return assemble({name: values[name] for name, text in typed.items() if text is not None})


def _write(text: str, target: Path) -> None:
    from stickslip.files import writing

    with writing(target, "-o") as stream:
        stream.write(text.encode())

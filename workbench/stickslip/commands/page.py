"""`stickslip page` and `stickslip explore`: the interactive page, as a file and in the browser."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.commands.expanded import command
from stickslip.commands.shared import say
from stickslip.errors import CommandError
from stickslip.files import write
from stickslip.parameters import ParameterError, Parameters

DEFAULT_PAGE = Path("stick-slip.html")

_Shown = Annotated[Parameters, "m g k c mu_s mu_k v load"]


@command
def page(*, p: _Shown, output: Path = DEFAULT_PAGE, address: str = "") -> None:
    """Write the interactive page: one HTML file that works without a network."""
    from stickslip.page.assemble import CARD, card

    if address and not address.startswith(("http://", "https://")):
        raise CommandError(f"--address {address}: expected a whole address, such as https://...")
    print(f"{output}  {_write(p, output, address)} bytes")
    if address:
        write(output.with_name(CARD), card(), "--address")


@command
def explore(*, p: _Shown) -> None:
    """Open the interactive page in the browser: drag a slider, see it stick and slip."""
    import tempfile
    import webbrowser

    # The browser reads it after this process has ended, so it stays.
    file = Path(tempfile.mkdtemp(prefix="stickslip-")) / DEFAULT_PAGE
    _write(p, file)
    print(file)
    if not webbrowser.open(file.as_uri()):
        say("no browser could be started: open that file in one")
        raise typer.Exit(1)


def _write(p: Parameters, target: Path, address: str = "") -> int:
    """Write the page that begins with the values given; return its length in bytes."""
    from stickslip.page import page as assemble
    from stickslip.page import page_range

    for name, value in p.given.items():
        low, high, unit = page_range(name)
        if not low <= value <= high:
            shown = f"{low:g} to {high:g} {unit}".rstrip()
            raise ParameterError(name, f" {value:g}: the page shows {shown}")
    content = assemble(dict(p.given), address).encode()
    write(target, content, "-o")
    return len(content)

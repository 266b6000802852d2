"""`stickslip map`: the steady motion over ranges of two parameters or more."""

import re
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from stickslip.commands.expanded import Computing, command
from stickslip.errors import CommandError
from stickslip.parameters import Parameters

if TYPE_CHECKING:
    import xarray


@command
def map(  # noqa: A001 - the name of the command
    axis: Path | None = None,
    *,
    over: Mapping[str, str],
    output: str | None = None,
    p: Annotated[Parameters, "m g k c mu_s mu_k tau_s B t_0 v load law own curve normal_force"],
    computing: Computing,
    feed: str | None = None,
    limit: bool | None = None,
) -> None:
    """Map jump, period and regime over two parameters or more: pictures, a page and a dataset."""
    from stickslip import studies
    from stickslip.commands.shared import computed
    from stickslip_design.maps.sources import OverError

    options = {each: "--" + each.replace("_", "-") for each in p.given}
    options |= dict.fromkeys(p.own, "--law-parameter")
    if axis is None:
        if feed is not None:
            raise CommandError("--feed goes with an axis file; the block has --v")
    else:
        of_block = [*options.values(), *(["--curve"] if p.curve else [])]
        if p.law != Parameters().law:
            of_block.append("--law")
        if of_block:
            raise CommandError(
                f"{of_block[0]} goes with a map of the block; {axis} states the axis"
            )
        options = {} if feed is None else {"feed": "--feed"}
    for name in over:
        of_curve = p.curve and re.fullmatch(r"shape|n_points|mu_\d+|u_\d+", name)
        if (other := "--curve" if of_curve else options.get(name)) is not None:
            raise CommandError(f"--over: {name} is set by {other} too")
    folder = output or f"{p.law if axis is None else axis.stem}-map"
    if "://" not in folder and Path(folder).exists() and not Path(folder).is_dir():
        raise CommandError(f"-o {folder}: it is a file; name a folder")
    compute = partial(computed, computing=computing, described="Computing the map")
    try:
        dataset = studies.map(
            over, p, axis=axis, feed=feed, limit=limit, folder=folder, compute=compute
        )
    except OverError as error:
        raise CommandError(f"--over: {error}") from error
    _show(dataset, folder)


def _show(dataset: "xarray.Dataset", folder: str) -> None:
    """Write picture and page beside the dataset, and print what the map says."""
    from stickslip.files import refused
    from stickslip_design.chunks.store import Store
    from stickslip_design.maps.page import MOST_SLICES, page, picture
    from stickslip_design.maps.study import FILE
    from stickslip_design.maps.views import View

    view = View(dataset)
    (drawn,), told = view.slices([view.nearest()]), view.overall()
    files = {
        "map.png": picture(view, drawn),
        "index.html": page(view, view.places(MOST_SLICES), told).encode("utf-8"),
    }
    store = Store(folder)
    for name, content in files.items():
        with refused(folder, "-o", f"write {name}"):
            store.write(name, content)
    print("\n".join(told))
    print("files:", ", ".join(f"{folder}/{name}" for name in (FILE, *files)))

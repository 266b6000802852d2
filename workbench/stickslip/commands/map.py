"""`stickslip map`: the steady motion over ranges of two parameters or more."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stickslip.commands.expanded import Only, command, named
from stickslip.commands.options import Computing
from stickslip.commands.shared import say
from stickslip.errors import CommandError
from stickslip.parameters import Parameters, above_zero

if TYPE_CHECKING:
    import xarray

    from stickslip_design.maps.grid import GridStudy


@command
def map(  # noqa: A001 - the name of the command
    *,
    axis: Annotated[
        Path | None,
        typer.Argument(
            metavar="AXIS.toml",
            help="An axis file; without it the block is mapped.",
            show_default=False,
        ),
    ] = None,
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="'NAME=LOW..HIGH UNIT log|lin COUNT'",
            help="A parameter and its range, such as 'v=0.1..50 mm/s log 400'; two or more. Of an "
            "axis file a number that it states (axis.stiffness), or feed. Default: lin 200.",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FOLDER",
            help="Folder, or address of fsspec, of the map; default: NAME-map in this folder.",
            show_default=False,
        ),
    ] = None,
    p: Annotated[
        Parameters,
        Only("m g k c mu_s mu_k tau_s B t_0 v load law own curve normal_force"),
    ],
    computing: Computing,
    feed: Annotated[
        str | None,
        typer.Option(
            metavar="VALUE",
            help="Feed of the axis, where the map is not over it; default: the first demanded.",
            show_default=False,
        ),
    ] = None,
    limit: Annotated[
        bool | None,
        typer.Option(
            "--limit/--no-limit",
            help="Whether the critical velocity of the block is searched, at 10 to 100 ms each "
            "where friction has no closed form; default: up to 1000 searches.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Map jump, period and regime over two parameters or more: pictures, a page and a dataset."""
    from stickslip.commands.running import computed as run
    from stickslip_design.maps.study import computed

    values, name = p.values, p.law
    held = {each: "--" + each.replace("_", "-") for each in p.given}
    held |= dict.fromkeys(p.own, "--law-parameter")
    if axis is None:
        if feed is not None:
            raise CommandError("--feed goes with an axis file; the block has --v")
    else:
        given = [*held.values(), *(["--curve"] if p.curve else [])]
        if p.law != Parameters().law:
            given.append("--law")
        if given:
            raise CommandError(f"{given[0]} goes with a map of the block; {axis} states the axis")
        values = {} if feed is None else {"feed": above_zero(feed, "m/s", "feed")}
        held, name = {} if feed is None else {"feed": "--feed"}, axis.stem
    study = _study(over or [], axis, p.law, values, held, p.curve, limit)
    folder = output or f"{name}-map"
    _check_folder(folder)
    dataset = computed(
        study,
        folder=folder,
        run=lambda place: run(study, place, described="Computing the map", **vars(computing)),
    )
    _show(dataset, folder)


def _study(
    over: list[str],
    axis: Path | None,
    law: str,
    values: Mapping[str, float],
    held: Mapping[str, str],
    curve: Path | None,
    limit: bool | None,
) -> "GridStudy":
    from stickslip_design.datasets import need
    from stickslip_design.maps.over import OverError
    from stickslip_design.maps.study import study_of
    from stickslip_design.points.slips import native_problem

    for package in ("xarray", "zarr"):
        need(package)
    try:
        ranges = named(over, "--over")
        for name in ranges:
            of_curve = curve is not None and re.fullmatch(r"shape|n_points|mu_\d+|u_\d+", name)
            by = "--curve" if of_curve else held.get(name)
            if by is not None:
                raise OverError(f"{name} is set by {by} too")
        study = study_of(ranges, values=values, law=law, axis=axis, limit=limit)
    except OverError as error:
        raise CommandError(f"--over: {error}") from error
    if study.source.by_slips and (problem := native_problem()) is not None:
        say(f"warning: {problem}; the Python block computes, some hundred times slower")
    return study


def _check_folder(folder: str) -> None:
    """Refuse a folder that cannot be one before the study, not after it."""
    path = Path(folder)
    if "://" not in folder and path.exists() and not path.is_dir():
        raise CommandError(f"-o {folder}: it is a file; name a folder")


def _show(dataset: "xarray.Dataset", folder: str) -> None:
    """Write picture and page beside the dataset, and print what the map says."""
    from stickslip_design.maps.page import MOST_SLICES, page
    from stickslip_design.maps.pictures import picture
    from stickslip_design.maps.study import FILE
    from stickslip_design.maps.views import View

    view = View(dataset)
    (drawn,), told = view.slices([view.nearest()]), view.overall()
    files = {
        "map.png": picture(view, drawn),
        "index.html": page(view, view.slices(view.places(MOST_SLICES)), told).encode("utf-8"),
    }
    for name, content in files.items():
        _write(folder, name, content)
    print("\n".join(told))
    print("files:", ", ".join(f"{folder}/{name}" for name in (FILE, *files)))


def _write(folder: str, name: str, content: bytes) -> None:
    if "://" in folder:
        from stickslip_design.chunks.store import store_of

        store_of(folder).write(name, content)
        return
    from stickslip.files import writing

    with writing(Path(folder, name), "-o") as stream:
        stream.write(content)

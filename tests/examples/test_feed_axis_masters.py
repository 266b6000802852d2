"""The SSP file in fmpy, ecos and libcosim: each in a process that cannot import the project."""

import re
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray

from examples.feed_axis import masters, ssp
from examples.feed_axis.axis import Axis
from examples.feed_axis.run import run_in as run_apart
from examples.feed_axis.run import write_all
from stickslip.errors import CommandError
from tests.needs import needs
from tests.python import python

from .running import run_all

STOP, STEP = 0.5, 250e-6
BARRED = Path(__file__).with_name("barred.py")
SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
FMPY = "fmpy"
ECOS = pytest.param("ecos", marks=needs("ecospy"))
LIBCOSIM = pytest.param("libcosim", marks=needs("libcosimpy"))

Columns = dict[str, NDArray[np.float64]]


@pytest.fixture(scope="module")
def axis_file(fmus: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the SSP file of the axis as it is."""
    return ssp.write_ssp(tmp_path_factory.mktemp("ssp") / "FeedAxis.ssp", Axis(), fmus)


@pytest.fixture(scope="module")
def own(fmus: Path) -> Columns:
    """Return what the example's own master finds, from the first step's end on."""
    names = [name.partition(".")[2] for name in ssp.OUTPUTS]
    (columns,) = run_all(fmus, [({}, STOP, STEP, "jacobi")], *names)
    return {name: column[1:] for name, column in zip(ssp.OUTPUTS, columns, strict=True)}


def run_in(master: str, file: Path, folder: Path, stop: float = STOP) -> Columns:
    """Run a file in a master, in a process that cannot import the project."""
    table = folder / f"{master}.csv"
    words = [master, str(file), str(stop), str(STEP), str(table), *ssp.OUTPUTS]
    python("-I", BARRED, masters.__file__, *words)
    rows = np.genfromtxt(table, delimiter=",", skip_header=1)
    return dict(zip(("time", *ssp.OUTPUTS), rows.T, strict=True))


@needs("cc")
def test_the_native_table_shows_the_same_bits(own: Columns, tmp_path: Path) -> None:
    """With the table in C, beside a drive in Python, fmpy records the same bits."""
    found = run_in(FMPY, write_all(tmp_path, Axis(), native=True), tmp_path)
    for name, column in own.items():
        assert np.array_equal(found[name], column), name


@pytest.mark.parametrize("master", [FMPY, ECOS])
def test_masters_that_step_both_at_once_agree_in_every_bit(
    master: str, axis_file: Path, own: Columns, tmp_path: Path
) -> None:
    """Fmpy and ecos give what stepping both over the same interval gives, bit for bit."""
    found = run_in(master, axis_file, tmp_path)
    for name, column in own.items():
        assert found[name].tolist() == column.tolist(), name


@needs("libcosimpy")
def test_libcosim_differs_by_its_whole_nanoseconds_only(
    axis_file: Path, own: Columns, tmp_path: Path
) -> None:
    """Libcosim steps both at once too, by steps that differ from ours in the last digits."""
    found = run_in("libcosim", axis_file, tmp_path)
    # A step of 2.5e-4 s differs by 1 ulp of time, 1e-16 s; the force that the velocity loop makes
    # of a position's rounding, K_p 1e-19 m / T_s = 3e-10 N, is nothing. The axis is stable, so
    # differences stay; a count of an encoder that fell the other way would be 1e-8 m or more.
    assert np.max(np.abs(found["table.x"] - own["table.x"])) < 1e-11
    assert np.max(np.abs(found["drive.x_motor"] - own["drive.x_motor"])) < 1e-11
    assert np.ptp(own["table.x"]) > 2e-4


@pytest.mark.parametrize("master", [FMPY, ECOS, LIBCOSIM])
def test_inputs_of_the_first_step(master: str, fmus: Path, tmp_path: Path) -> None:
    """Ecos and libcosim hand over the outputs at the start; fmpy's first step has inputs of 0."""
    file = ssp.write_ssp(tmp_path / "loaded.ssp", Loaded(feed=0.0), fmus)
    found = run_in(master, file, tmp_path, stop=4 * STEP)
    moved = 0.5 * (4e7 * 5e-6) / Axis().m_d * STEP**2
    assert found["table.F"][0] == pytest.approx(200.0)
    # The position grows by a rounding of 1e-6 of itself through the spring's reaction.
    assert found["drive.x_motor"][0] == pytest.approx(0.0 if master == FMPY else -moved, rel=1e-5)


class Loaded(Axis):
    """An axis whose spring is loaded at the start, by 200 N."""

    def of_table(self) -> dict[str, float]:
        """Return the start values of the table, with a spring that is not relaxed."""
        return {**super().of_table(), "z_start": 5e-6}


class Refused(Axis):
    """An axis with a position gain that the drive refuses."""

    def of_drive(self) -> dict[str, float]:
        """Return the start values of the drive, one of them out of range."""
        return {**super().of_drive(), "K_v": -1.0}


@pytest.mark.parametrize("master", [FMPY, ECOS, LIBCOSIM])
def test_a_refused_value_is_told(
    master: str, fmus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What the drive refuses is said with name and range, also where the master goes on."""
    file = ssp.write_ssp(tmp_path / "refused.ssp", Refused(), fmus)
    reason = "K_v = -1.0 1/s is out of range: it must be finite and at least 0"
    if master == "ecos":
        found = run_apart(master, file, 4 * STEP, STEP)
        assert not found["x_motor"].any()
        assert reason in capsys.readouterr().err
    else:
        with pytest.raises(CommandError, match=re.escape(reason)):
            run_apart(master, file, 4 * STEP, STEP)


def test_the_file_is_a_valid_ssp(axis_file: Path) -> None:
    """It passes the schemas, and wires the drive's v, and the table's F and x."""
    from fmpy.ssp.ssd import read_ssd, read_ssv

    description = read_ssd(str(axis_file), validate=True)
    read_ssv(str(axis_file), "parameters.ssv", validate=True)
    wires = {
        (each.startElement, each.startConnector, each.endElement, each.endConnector)
        for each in description.system.connections
    }
    assert wires == {
        ("drive", "v", "table", "v"),
        ("table", "F", "drive", "F"),
        ("table", "x", "drive", "x"),
    }


def test_both_places_of_the_numbers_say_the_same(axis_file: Path) -> None:
    """What stands in parameters.ssv stands inside the components, name by name."""
    with zipfile.ZipFile(axis_file) as archive:
        system = ElementTree.fromstring(archive.read("parameters.ssv"))
        structure = ElementTree.fromstring(archive.read("SystemStructure.ssd"))
    inside = {
        f"{component.get('name')}.{name}": value
        for component in structure.iter()
        if component.tag.endswith("}Component")
        for name, value in parameters(component).items()
    }
    assert inside == parameters(system)
    assert inside["drive.on_table"] == ("Integer", "1")
    assert all(kind == "Real" for name, (kind, _) in inside.items() if name != "drive.on_table")


def parameters(tree: ElementTree.Element) -> dict[str, tuple[str, str]]:
    """Return type and value of every parameter by name."""
    return {
        str(each.get("name")): (each[0].tag.removeprefix(SSV), str(each[0].get("value")))
        for each in tree.iter(f"{SSV}Parameter")
    }

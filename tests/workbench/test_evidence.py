"""The evidence in the FMU: an experiment, its result, the report, and the manifest of them."""

import hashlib
import re
import zipfile
from pathlib import Path
from urllib.parse import urljoin
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv

from stickslip_fmu.spec import TABLE
from stickslip_verification.drive.description import content_digest
from tests.python import run

from .running import Command

pytestmark = pytest.mark.gate
FOLDER = "extra/org.fmi-standard.fmi-ls-ref/"
MOST_BYTES = 420_000


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(tmp_path_factory.mktemp("built") / "StickSlip.fmu")


def build(target: Path, *options: str) -> Path:
    with pytest.MonkeyPatch.context() as patch:
        command = Command(patch, None, target)  # type: ignore[arg-type]
        assert command.in_fresh_process("build", "-o", target, *options).code == 0
    return target


def test_two_builds_are_the_same_bytes(built: Path, tmp_path: Path) -> None:
    again = build(tmp_path / "StickSlip.fmu")
    assert again.read_bytes() == built.read_bytes()
    assert built.stat().st_size < MOST_BYTES


def test_the_report_names_the_content_it_judged(built: Path, tmp_path: Path) -> None:
    bare = build(tmp_path / "bare.fmu", "--bare")
    folder = tmp_path / "unpacked"
    with zipfile.ZipFile(built) as archive:
        report = archive.read(FOLDER + "report.html").decode()
        archive.extractall(folder)
    (named,) = re.findall(r"<code>([0-9a-f]{64})</code>", report)
    assert named == content_digest(built) == content_digest(bare)
    (line,) = re.findall(r"<pre><code>(.*)</code></pre>", report)
    shell = line.replace("&#39;", "'").replace("&lt;", "<").replace("&gt;", ">")
    said = run("sh", "-c", shell, cwd=folder)
    assert said.stdout.split()[0] == named


def test_the_report_passes_and_carries_no_date(built: Path) -> None:
    with zipfile.ZipFile(built) as archive:
        report = archive.read(FOLDER + "report.html").decode()
    assert 'verification <span class="badge big pass">pass</span>' in report
    passed, total = map(int, re.findall(r"(\d+) of (\d+) comparisons passed", report)[0])
    assert passed == total > 50
    assert not re.search(r"20\d\d-\d\d-\d\d", report)
    for word in ("http", "src=", "url("):
        assert word not in report


def test_the_manifest_describes_the_files(built: Path) -> None:
    with zipfile.ZipFile(built) as archive:
        names = set(archive.namelist())
        root = ElementTree.fromstring(archive.read(FOLDER + "fmi-ls-manifest.xml"))
        contents = {name: archive.read(name) for name in names if name.startswith(FOLDER)}
    space = "{http://fmi-standard.org/fmi-ls-manifest}"
    assert root.tag == "fmiReferences"
    assert root.get(f"{space}fmi-ls-name") == "org.fmi-standard.fmi-ls-ref"
    assert {each.tag for each in root} == {"Related"}
    assert [each.get("role") for each in root] == ["experiment/smoke-test", "result", "report"]
    for each in root:
        name = urljoin(FOLDER, each.get("source"))
        assert hashlib.sha3_256(contents.pop(name)).hexdigest() == each.get("checksum")
    assert list(contents) == [FOLDER + "fmi-ls-manifest.xml"]
    assert "documentation/fmi-ls-ref.html" in names


def test_the_experiment_gives_the_result(built: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(built) as archive:
        root = ElementTree.fromstring(archive.read(FOLDER + "default.experiments.xml"))
        (experiment,) = root
        (reference,) = experiment
        result = archive.extract(FOLDER + (reference.get("source") or ""), tmp_path)
    assert (root.tag, experiment.tag, reference.tag) == ("Experiments", "Experiment", "References")
    stop_time, step = (float(experiment.get(name) or "nan") for name in ("stopTime", "stepSize"))
    packed = read_csv(result)
    names = [name for name in packed.dtype.names if name != "time"]
    assert set(names) == {
        row.name for row in TABLE.rows if row.causality == "output" and row.unit != "J"
    }
    run = fmpy.simulate_fmu(str(built), stop_time=stop_time, output_interval=step, output=names)
    for name in packed.dtype.names:
        assert np.array_equal(packed[name], run[name]), name

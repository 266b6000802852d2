"""Wrong use of every command: exit code 2, one line with name, value and range, no file touched."""

import shlex
import sys
import zipfile
from pathlib import Path

import pytest

from stickslip_design.axis import example, template
from tests.makers import SLIDER
from tests.needs import needs
from tests.workbench.running import Command

AXIS = """
[axis]
mass = "500 kg ± 5 %"
stiffness = "40 N/um"
zeta = "5 %"
[friction]
mu_s = "0.20 ± 10 %"
mu_k = "0.15 ± 20 %"
[demand]
feeds = ["2 mm/min", "1 mm/s"]
"""
PLAN = """\
stop_time = "2 s"
step = "2 s"
[parameters]
k = "500..2000 N/m log 3"
[outputs]
delta_x = "last"
"""
FILES = {
    "axis.toml": AXIS,
    "minus.toml": AXIS.replace('"500 kg', '"-5 kg'),
    "swings.toml": example().replace('"25 1/s"', '"2000 1/s"'),
    "table.toml": template("rotary"),
    "plan.toml": PLAN,
    "many.toml": PLAN.replace('log 3"', 'log 1000000"\nmu_s = "0.4..0.9 600000"'),
    "memory.toml": PLAN.replace('log 3"', 'log 1000000000"\nmu_s = [0.4, 0.5]'),
    "runs.toml": PLAN.replace("k =", "".join(f'{n} = "0..1 9999999"\n' for n in "mgc") + "k ="),
    "mu.csv": "speed [m/s],mu\n0,0.42\n0.1,0.3\n",
    "unitless.csv": "speed,force\n0,40\n5 mm/s,30\n",
    "text.fmu": "no archive",
    "broken.toml": "id = = 1\n",
    "empty.csv": "",
    "timeless.csv": "x,F\n0,0\n",
    "speeds.csv": "t,x,F\n0,0,1\n0.1,1,2\n",
    "rest.csv": "t,x,F\n" + "".join(f"{n},0,{n}\n" for n in range(50)),
    "word.csv": "t,x\n0,0\n0.1,much\n",
}
REFUSED = [
    ("", "Missing command"),
    ("fly", "fly"),
    ("simulate --k -1", "--k '-1' | above 0"),
    ("simulate --v '5 N'", "--v '5 N' is a force | a velocity in m/s"),
    ("simulate --v 20 mm/s", "extra argument | 20mm/s, or '20 mm/s'"),
    ("map --over v=1..9 mm/s", "no such file | v=1..9mm/s, or 'v=1..9 mm/s'"),
    ("simulate --load -10", "load = -10.0 N | at least -m g = -9.81 N"),
    ("simulate --start-time 2 --stop-time 1", "--stop-time '1' | > 2 s"),
    ("simulate --output-interval 1e-12", "--output-interval '1e-12' | at least 1e-05 s"),
    # One period is 0.31527 s, by (11) of the theory.
    ("simulate --stop-time 1e9", "about 3.17e+09 slips, and 1000000 are | --most-slips 317190"),
    ("simulate --stop-time 1e4 --engine reference", "3.17e+04 slips, and 10000 are"),
    ("simulate --law stribeck --law-parameter v_s=1mm/s --stop-time 1e9", "e+09 slips"),
    ("simulate --output-file missing/run.csv", "--output-file | no folder missing"),
    ("simulate --output-file .", "--output-file | it is a folder"),
    ("simulate --plot run.gif", "--plot run.gif | .png, .svg or .pdf"),
    ("simulate --engine abaqus", "--engine | abaqus | fmu | reference"),
    ("simulate --fmu none.fmu", "--fmu none.fmu: | no such file"),
    ("simulate --fmu text.fmu --output-file axis.toml", "--fmu text.fmu: not an FMU"),
    ("simulate --engine reference --fmu a.fmu", "--fmu | --engine fmu only"),
    ("simulate --spring 1", "--spring"),
    ("simulate --curve mu.csv --law coulomb", "--curve goes with law stribeck, not with law"),
    ("build --ssp source --axis axis.toml", "the system with a source has no axis"),
    ("build --ssp drive --axis axis.toml", "the FMUs have a drive, constant coefficients of"),
    ("build --ssp pair --law stribeck", "an axis has Coulomb's friction law"),
    ("build --ssp source --fmi 3", "--fmi 3: a system (SSP 1.0) is made of FMUs 2.0"),
    ("build --axis axis.toml", "--axis goes with ssp drive or pair"),
    ("build --ssp source -o a.fmu", "a.fmu: the name of an FMU ends in .fmu, of a system"),
    ("page --v -5mm/s", "--v -0.005 | 1e-15 to 1e+06 m/s"),
    ("page --load '-20 N'", "load = -20.0 N | at least -m g = -9.81 N"),
    ("page -o missing/a.html", "-o missing/a.html | no folder missing"),
    ("critical --curve mu.csv --normal-force '200 N'", "--normal-force: | mu.csv | coefficients"),
    ("critical --curve unitless.csv --normal-force 9N", "line 2: 40 has no unit | 'force [N]'"),
    ("critical --curve mu.csv --law-parameter u_2=1", "--law-parameter u_2: | mu.csv | sets it"),
    ("score none.csv", "none.csv: no such file"),
    ("score empty.csv", "empty.csv | empty"),
    ("score timeless.csv", "timeless.csv | time"),
    ("score word.csv", "word.csv | line 3"),
    ("design", "no axis file is named"),
    ("design none.toml", "none.toml: cannot be read: no such file"),
    ("design minus.toml --json axis.json", 'minus.toml: line 3: axis.mass = "-5 kg | is out of'),
    ("design axis.toml -o no/report.html", "there is no folder no"),
    ("design axis.toml -o axis.toml", "that is the axis file"),
    ("design axis.toml --json ./axis.html", "the report goes there"),
    ("design axis.toml minus.toml", "minus.toml: one axis has a report; --compare sets several"),
    ("design --compare", "no axis file is named"),
    ("design --compare axis.toml", "needs two axes or more"),
    ("design --compare axis.toml axis.toml", "each of them once"),
    ("design --compare axis.toml none.toml", "none.toml: cannot be read: no such file"),
    ("design --compare axis.toml minus.toml", 'minus.toml: line 3: axis.mass = "-5 kg | is out of'),
    ("design --compare axis.toml minus.toml -o x.html", "prints a table: without -o"),
    ("design --compare axis.toml plan.toml --json plan.toml", "that is the axis file"),
    ("design --template --example", "give one of them"),
    ("design --template -o x.html", "without -o and --json"),
    ("design --template axis.toml", "there is such a file already"),
    ("identify none.csv", "none.csv"),
    ("identify word.csv", "word.csv: | line 3"),
    ("identify speeds.csv", "speeds.csv: "),
    ("identify rest.csv", "rest.csv: no motion is left to judge: the table rests, or the force is"),
    ("identify speeds.csv -o speeds.csv", "--output speeds.csv: that is another file"),
    (
        "identify speeds.csv --axis axis.toml --write axis.toml",
        "--write axis.toml: that is another",
    ),
    (
        "identify speeds.csv --json plan.toml --write plan.toml",
        "--write plan.toml: that is another",
    ),
    ("identify speeds.csv --axis minus.toml", "minus.toml: line 3: axis.mass"),
    ("identify speeds.csv --column position", "--column position: write NAME=VALUE"),
    ("identify speeds.csv --column way=x", "way is none of t, position"),
    ("reversal none.toml", "none.toml: cannot be read: no such file"),
    ("reversal axis.toml --with minus.toml", 'minus.toml: line 3: axis.mass = "-5 kg | is out of'),
    ("reversal table.toml", 'drive.kind = "rotary" is not for the circular test'),
    ("reversal swings.toml", "X axis: its loop is unstable"),
    ("reversal axis.toml --feeds 5N", "--feeds '5N' is a force; expected a velocity"),
    (
        "reversal axis.toml --feeds 1m/min --feeds 0",
        "--feeds '0' is out of range: it must be above",
    ),
    ("reversal axis.toml --radii -3mm", "--radii '-3mm' is out of range: it must be above 0 m"),
    ("reversal axis.toml --shares 300%", "--shares 3 is out of range: it must be from 0 to 2"),
    ("reversal axis.toml --plot a.gif", "--plot a.gif: unknown format | .png, .svg or .pdf"),
    ("reversal axis.toml --plot none/a.png", "--plot none/a.png: | no folder none"),
    ("names none.fmu", "none.fmu: | no such file"),
    ("names {slider} -o none/names.toml", "-o none/names.toml: "),
    ("names {slider} -o axis.toml", "it is there already, and may have been edited"),
    ("verify --cases heat,none", "no case matches 'none'"),
    ("verify --fmu text.fmu", "not an FMU"),
    ("verify --fmu {slider} --pack", "is not the exact block"),
    ("verify --fmu {slider} --names {names} --pack", "--pack does not go with --names"),
    ("verify --names {names}", "--names goes with --fmu"),
    ("verify --cases broken.toml", "broken.toml: line 1: "),
    ("verify --cases one-step --pack", "--pack does not go with --cases"),
    ("verify --jobs 0", "--jobs"),
    ("verify --budget 0", "--budget 0.0: must be above 0 s"),
    ("verify --memory nan", "--memory nan: must be 0.1 GB at least"),
    ("verify --within 1", "--within 1: must be above 0 % and below 100 %, as 1% or as 0.01"),
    ("verify --contract other", "'other' is not one of 'exact', 'physics'"),
    ("verify --contract exact --strict", "--strict does not go with --contract"),
    ("verify --contract exact --pack", "--pack does not go with --contract"),
    ("verify --interface me", "--interface me goes with --fmu"),
    ("verify --interface me --fmu {fmu} --strict", "do not go with --interface me"),
    ("verify -o text.fmu/report", "-o "),
    ("sweep text.fmu plan.toml", "text.fmu: not an FMU (not a zip archive)"),
    ("sweep text.fmu", "--template"),
    ("sweep {fmu} plan.toml --template", "plan.toml: there is such a file already"),
    (
        "sweep {fmu} memory.toml",
        "line 4, parameters.k: k = '500..2000 N/m log 1000000000' has 1000000000 values; 2",
    ),
    ("sweep {fmu} runs.toml", "3e+21 points are more than 10^9; --yes computes"),
    ("sweep {fmu} many.toml -o out", "6e+11 points are more than 10^9; --yes computes them"),
]
VK = "map --over 'v=1..900 mm/s' --over 'k=0.1..10 kN/m'"
V = "map --over 'v=1..9 mm/s'"
STUDIES = [
    ("map", "--over: a map is over two parameters or more, not 0"),
    (f"{V} --over 'k=2..2 N/m'", "--over: 'k=2..2 N/m' is empty"),
    (f"{VK} --v '3 mm/s'", "--over: v is set by --v too"),
    (
        f"{V} --over v_s=1..9mm/s --law stribeck --law-parameter v_s=3mm/s",
        "--over: v_s is set by --law-parameter too",
    ),
    (
        "map axis.toml --over feed=1..9mm/s --over axis.mass=1..2kg --feed 1mm/s",
        "--over: feed is set by --feed too",
    ),
    (f"{VK} --feed 1mm/s", "--feed goes with an axis file"),
    (VK.replace("map", "map axis.toml") + " --k 3", "--k goes with a map of the block; axis.toml"),
    (f"{VK} --workers 2 --cluster tcp://host:1", "--workers goes with this machine, not with"),
    (f"{VK} -o axis.toml", "-o axis.toml: it is a file; name a folder"),
]
SCATTER = [
    ("--vary 'friction.mu=normal 0.2 0.02'", "nearest: friction.mu_s, friction.mu_k"),
    ("--vary friction.mu_s", "--vary friction.mu_s: write NAME=VALUE"),
    ("--vary axis.mass=fixed --vary 'axis.mass=± 1 %'", "axis.mass stands twice"),
    ("--correlation friction.mu_s,friction.mu_k=x", "x is no number from -1 to 1"),
    ("--correlation friction.mu_s=0.5", "write NAME,NAME=VALUE"),
    ("--feed '0 mm/s'", "feed 0 mm/s is out of range"),
    ("--hold '2 at 2 mm/min' --solve friction.mu_s", "a share of 2 is out of range"),
]


@pytest.fixture(autouse=True)
def files(tmp_path: Path) -> None:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")


def refused(command: Command, line: str, parts: str, **places: object) -> None:
    said = command.refuses(*(word.format(**places) for word in shlex.split(line)))
    assert all(part in said for part in parts.split(" | ")), said


@pytest.mark.parametrize(("line", "parts"), REFUSED, ids=[line for line, _ in REFUSED])
def test_wrong_use_is_refused(command: Command, fmu_path: Path, line: str, parts: str) -> None:
    refused(command, line, parts, slider=SLIDER.path, names=SLIDER.names_file, fmu=fmu_path)


@needs("studies")
# Without a compiler slips are followed by the Python block, which is told.
@pytest.mark.filterwarnings("ignore:.*the Python block computes")
@pytest.mark.parametrize(("line", "parts"), STUDIES, ids=[line for line, _ in STUDIES])
def test_a_wrong_map_is_refused(command: Command, line: str, parts: str) -> None:
    refused(command, line, parts)


@pytest.mark.parametrize(("options", "parts"), SCATTER, ids=[options for options, _ in SCATTER])
def test_a_wrong_scatter_is_refused(command: Command, options: str, parts: str) -> None:
    refused(command, f"scatter axis.toml -o out {options}", parts)


@needs("studies")
def test_a_scatter_into_the_axis_file_is_refused(command: Command) -> None:
    assert "axis.toml" in command.refuses("scatter", "axis.toml", "-o", "axis.toml")


def test_studies_without_their_packages_say_what_installs_them(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    said = command.refuses(*shlex.split(VK))
    assert f"{shlex.quote(sys.executable)} -m pip install '" in said
    assert "'xarray>=" in said


@pytest.mark.parametrize("subcommand", ["simulate", "verify"])
@pytest.mark.parametrize("damage", ["no description", "no XML", "bytes"])
def test_a_damaged_fmu_is_refused(
    command: Command, fmu_path: Path, subcommand: str, damage: str
) -> None:
    file = Path("damaged.fmu")
    if damage == "bytes":
        with zipfile.ZipFile(fmu_path) as archive:
            binary = max(archive.infolist(), key=lambda member: member.compress_size)
        content = bytearray(fmu_path.read_bytes())
        middle = binary.header_offset + binary.compress_size // 2
        content[middle : middle + 100] = b"\xff" * 100
        file.write_bytes(content)
    else:
        with zipfile.ZipFile(file, "w") as archive:
            name = "readme.txt" if damage == "no description" else "modelDescription.xml"
            archive.writestr(name, "not XML")
    said = command.refuses(subcommand, "--fmu", file)
    assert "damaged.fmu" in said
    assert damage == "bytes" or "not an FMU" in said

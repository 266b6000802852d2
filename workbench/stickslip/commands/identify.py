"""`stickslip identify`: from a record of a drive or a pull test to the numbers of an axis."""

from collections.abc import Mapping
from pathlib import Path

from stickslip.commands.expanded import command
from stickslip.commands.shared import console
from stickslip.errors import CommandError


@command
def identify(
    record: Path,
    *,
    axis: Path | None = None,
    column: Mapping[str, str],
    write: Path | None = None,
    output: Path | None = None,
    json: Path | None = None,
) -> None:
    """Say what a record tells of an axis, each number with its interval, and what it cannot tell.

    The next command is `stickslip design` with the axis that --write has written.
    """
    from stickslip import files
    from stickslip.identified import identify as identified
    from stickslip.progress import meter

    report = output or Path(record.with_suffix(".html").name)
    asked = {"--output": report, "--write": write, "--json": json}
    targets = {option: target for option, target in asked.items() if target}
    taken = [each.resolve() for each in (record, axis) if each]
    for option, target in targets.items():
        if target.resolve() in taken or (target == write and target.exists()):
            raise CommandError(f"{option} {target}: that is another file; name a new one")
        files.check_writable(target, option)
        taken.append(target.resolve())
    with meter("Identifying"):
        found = identified(record, axis, column)
        texts = {"--output": found.html(), "--write": found.axis.text, "--json": found.to_json()}
    for option, target in targets.items():
        files.write(target, f"{texts[option].rstrip()}\n".encode(), option)
    console().print(found.table())
    print("report:", ", ".join(map(str, targets.values())))
    if write:
        print(f"next: stickslip design {write}")

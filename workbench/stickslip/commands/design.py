"""`stickslip design`: whether an axis judders, and what cures it."""

from pathlib import Path

from stickslip.commands.expanded import command
from stickslip.commands.shared import console, hand_out
from stickslip.errors import CommandError


@command
def design(
    axis: Path | None = None,
    others: list[Path] | None = None,
    *,
    compare: bool = False,
    output: Path | None = None,
    json: Path | None = None,
    presliding: bool = False,
    template: bool = False,
    kind: str = "",
    example: bool = False,
) -> None:
    """Say whether a feed axis judders, and what cures it: a summary, and a report to print."""
    if kind and not template:
        raise CommandError("--kind goes with --template: the file of an axis states its own")
    if presliding and (compare or template or example):
        raise CommandError("--presliding goes with one axis that is judged")
    if others and not compare:
        raise CommandError(f"{others[0]}: one axis has a report; --compare sets several in a table")
    if compare and (output is not None or template or example):
        raise CommandError("--compare prints a table: without -o, --template and --example")
    if template or example:
        if template and example:
            raise CommandError("--template and --example are two files: give one of them")
        if output is not None or json is not None:
            raise CommandError(
                "--template and --example study no axis: without -o and --json; the file to write "
                "is named without an option"
            )
        from stickslip_design.axis import TEMPLATES
        from stickslip_design.axis import example as example_text
        from stickslip_design.axis import template as template_text

        if kind not in {"", *TEMPLATES}:
            raise CommandError(f"--kind {kind}: there are {', '.join(TEMPLATES)}")
        text = example_text() if example else template_text(kind or "screw")
        option = "--example" if example else "--template"
        hand_out(text, axis, option, f"; next: stickslip design {axis}")
        return
    if axis is None:
        raise CommandError(
            "no axis file is named; stickslip design --template axis.toml writes one to fill in"
        )
    from stickslip import judgements
    from stickslip.files import check_writable, write
    from stickslip.progress import meter

    axes = [axis, *(others or ())]
    report = output or Path(axis.with_suffix(".html").name)
    targets = ({} if compare else {report: "--output"}) | ({} if json is None else {json: "--json"})
    for target, option in targets.items():
        if target.resolve() in [each.resolve() for each in axes]:
            raise CommandError(f"{option} {target}: that is the axis file; name another file")
        check_writable(target, option)
    if json is not None and not compare and report.resolve() == json.resolve():
        raise CommandError(f"--json {json}: the report goes there; name another file")
    with meter(f"Studying the {'axes' if compare else 'axis'}"):
        found = (
            judgements.compare(axes) if compare else judgements.design(axis, presliding=presliding)
        )
        texts = {report: found.html()} if isinstance(found, judgements.Design) else {}
        texts |= {} if json is None else {json: found.to_json() + "\n"}
    for target, text in texts.items():
        write(target, text.encode("utf-8"), targets[target])
    console().print(found.table())
    if texts:
        print("report:", ", ".join(map(str, texts)))

"""What strangers' checkers find in an FMU, and FMUs spoilt on purpose to show that they look."""

import logging
import zipfile
from io import BytesIO
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from tests.needs import needs

_DESCRIPTION = "modelDescription.xml"


def description_of(fmu: Path) -> bytes:
    with zipfile.ZipFile(fmu) as archive:
        return archive.read(_DESCRIPTION)


def by_schema(fmu: Path) -> list[str]:
    document = etree.parse(BytesIO(description_of(fmu)))
    version = document.getroot().get("fmiVersion")[0]
    folder = Path(fmpy.__file__).parent / "schema" / f"fmi{version}"
    schema = etree.XMLSchema(etree.parse(str(folder / f"fmi{version}ModelDescription.xsd")))
    schema.validate(document)
    return [str(error) for error in schema.error_log]


def by_fmpy(fmu: Path) -> list[str]:
    return list(validate_fmu(str(fmu)))


def by_toolbox(fmu: Path) -> list[str]:
    # An extra that only these tests need: without it the others still run.
    from fmu_manipulation_toolbox.checker import get_checkers
    from fmu_manipulation_toolbox.operations import FMU

    told: list[str] = []

    class Listener(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            told.append(record.getMessage())

    listener = Listener(logging.WARNING)
    logger = logging.getLogger("fmu_manipulation_toolbox")
    logger.addHandler(listener)
    try:
        with FMU(str(fmu)) as opened:
            checkers = [checker() for checker in get_checkers()]
            for checker in checkers:
                opened.apply_operation(checker)
    finally:
        logger.removeHandler(listener)
    assert len(checkers) >= 2
    return told


CHECKERS = (by_schema, by_fmpy, pytest.param(by_toolbox, marks=needs("fmutool")))

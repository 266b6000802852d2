"""All mistakes of masters that the wrapper is tried with."""

from typing import Any

from tests.fmu.importer import Importer
from tests.fmu.inside import mistakes_instances, mistakes_lists, mistakes_states, probing

TRIED = (mistakes_instances, mistakes_states, mistakes_lists)


def mistakes(importer: Importer, _: Any) -> Any:
    """Return by name what each mistake is and what came of it."""
    return probing.tried(importer)

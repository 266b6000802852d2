"""The native side of a friction law: its folder in laws/, and the sources that it takes."""

import re
from functools import lru_cache
from pathlib import Path
from typing import Dict, NamedTuple, Tuple

from fmi.model import Spec
from stickslip_fmu.laws.named import COULOMB_NAME, friction_law
from stickslip_fmu.spec import SPEC, spec_of

HOME = Path(__file__).parent
LAWS = HOME / "laws"
SHARED = LAWS / "shared"
_INCLUDED = re.compile(r'^#include "(.+)\.h"$', re.MULTILINE)


class NativeLaw(NamedTuple):
    """The native side of a friction law.

    Attributes
    ----------
    spec
        The specification of the block under the law.
    files
        C sources and headers of the law, those that it shares with other laws among them.
    """

    spec: Spec
    files: Tuple[Path, ...]


@lru_cache(maxsize=None)
def native_law(name: str = COULOMB_NAME) -> NativeLaw:
    """Return the native side of a friction law.

    Parameters
    ----------
    name
        Name of a built-in friction law, as `stickslip_fmu.laws.named.friction_law` takes it.

    Raises
    ------
    ValueError
        If there is no such law, or it has no native side.
    """
    law = friction_law(name).law
    folders = native_laws()
    if name not in folders:
        raise ValueError(
            f"the friction law {name!r} has no native side; {' and '.join(folders)} have one"
        )
    spec = SPEC if name == COULOMB_NAME else spec_of(law)
    return NativeLaw(spec, files_of(folders[name]))


def native_laws() -> Dict[str, Path]:
    """Return the folders of the friction laws that have a native side, by the law's name."""
    return {each.parent.name: each.parent for each in sorted(LAWS.glob("*/friction_law.h"))}


def files_of(folder: Path) -> Tuple[Path, ...]:
    """Return the files of a law's folder, and those of laws/shared whose headers they include."""
    files = sorted(folder.glob("*.[ch]"))
    # The list grows while it is read: shared files may include others.
    for file in files:
        for stem in _INCLUDED.findall(file.read_text()):
            files += [each for each in sorted(SHARED.glob(f"{stem}.[ch]")) if each not in files]
    return tuple(files)

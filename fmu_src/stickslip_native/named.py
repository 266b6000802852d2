"""The native side of a friction law: its folder in laws/, and the sources that it takes."""

import re
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple, Tuple

from fmi.model import Spec
from stickslip_fmu.laws.named import COULOMB_NAME, friction_law
from stickslip_fmu.laws.native_only import NativeOnly
from stickslip_fmu.spec import SPEC, spec_of

HOME = Path(__file__).parent
_LAWS = HOME / "laws"
_INCLUDED = re.compile(r'^#include "(.+)\.h"$', re.MULTILINE)


class NativeLaw(NamedTuple):
    """The native side of a friction law.

    Attributes
    ----------
    spec
        The specification of the block under the law.
    files
        C sources and headers of the law, those that it shares with other laws among them.
    whole
        Whether its motion is in C alone, integrated whole: core/law.h.
    """

    spec: Spec
    files: Tuple[Path, ...]
    whole: bool


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
    folders = {file.parent.name: file.parent for file in sorted(_LAWS.glob("*/friction_law.h"))}
    if name not in folders:
        raise ValueError(
            f"the friction law {name!r} has no native side; {', '.join(folders)} have one"
        )
    files = sorted(folders[name].glob("*.[ch]"))
    # The list grows while it is read: shared files may include others.
    for file in files:
        for stem in _INCLUDED.findall(file.read_text()):
            shared = sorted(_LAWS.glob(f"shared/{stem}.[ch]"))
            files += [file for file in shared if file not in files]
    spec = SPEC if name == COULOMB_NAME else spec_of(law)
    return NativeLaw(spec, tuple(files), isinstance(law, NativeOnly))

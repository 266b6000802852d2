"""The platforms of the native FMU: what is compiled for each, and where FMI keeps it.

FMI 2.0.4, section 2.3, names `linux64`, `win64` and `darwin64`, all of them x86-64, and refers to
the platform tuples of FMI 3.0 for every other processor. On Macs with an ARM processor FMPy looks
in `darwin64` nevertheless, so the library there is universal: one file with the code of both
processors.
"""

import platform
import struct
import sys
from typing import List, Literal, Mapping, NamedTuple, Optional, Tuple


class Platform(NamedTuple):
    """A platform.

    Attributes
    ----------
    triple
        Zig's name of the target: processor, system with its oldest version, C library with its
        oldest version.
    fmi2
        Folders in binaries/ in FMI 2.0.
    fmi3
        Folder in binaries/ in FMI 3.0: processor and system.
    suffix
        Ending of a library's name.
    """

    triple: str
    fmi2: Tuple[str, ...]
    fmi3: str
    suffix: str

    @property
    def processor(self) -> str:
        """x86_64 or aarch64."""
        return self.fmi3.partition("-")[0]

    @property
    def system(self) -> str:
        """linux, windows or darwin."""
        return self.fmi3.partition("-")[2]

    def folders(self, face: Literal[2, 3]) -> Tuple[str, ...]:
        """Return the folders in binaries/ for the major version of FMI."""
        return self.fmi2 if face == 2 else (self.fmi3,)


PLATFORMS: Tuple[Platform, ...] = (
    Platform("x86_64-linux-gnu.2.17", ("linux64",), "x86_64-linux", ".so"),
    Platform("aarch64-linux-gnu.2.17", ("aarch64-linux",), "aarch64-linux", ".so"),
    # With the Universal C Runtime, which is a part of Windows from version 10 on.
    Platform("x86_64-windows.win10-gnu", ("win64",), "x86_64-windows", ".dll"),
    Platform("x86_64-macos.11.0", ("darwin64",), "x86_64-darwin", ".dylib"),
    Platform("aarch64-macos.11.0", ("darwin64", "aarch64-darwin"), "aarch64-darwin", ".dylib"),
)

# What `platform.machine` calls the processors.
_PROCESSORS = {"amd64": "x86_64", "x86_64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64"}
_SYSTEMS = {"linux": "linux", "win32": "windows", "darwin": "darwin"}


def current() -> Optional[Platform]:
    """Return the platform that this process runs on, None if it is not among them."""
    processor = _PROCESSORS.get(platform.machine().lower(), "")
    name = f"{processor}-{_SYSTEMS.get(sys.platform, '')}"
    # A 32-bit process cannot load what is compiled here.
    fitting = [one for one in PLATFORMS if one.fmi3 == name and sys.maxsize > 2**32]
    return fitting[0] if fitting else None


# Processor types of Mach-O, and the alignment of a library in a universal one [powers of two].
_FAT_MAGIC = 0xCAFEBABE
_MACH_PROCESSORS = {"x86_64": (0x01000007, 3, 12), "aarch64": (0x0100000C, 0, 14)}


def universal(libraries: Mapping[Platform, bytes]) -> bytes:
    """Return one library for macOS with the code of several processors.

    The format is a table of big-endian numbers before the libraries (`mach-o/fat.h`). Zig brings
    no `lipo`, and that of Apple exists on macOS only.
    """
    head: List[bytes] = []
    body = b""
    start = 8 + 20 * len(libraries)
    for each, content in libraries.items():
        kind, subkind, alignment = _MACH_PROCESSORS[each.processor]
        body += b"\0" * (-(start + len(body)) % 2**alignment)
        head.append(struct.pack(">5I", kind, subkind, start + len(body), len(content), alignment))
        body += content
    return struct.pack(">2I", _FAT_MAGIC, len(libraries)) + b"".join(head) + body

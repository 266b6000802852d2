"""Runs: an FMU or the reference driven through a setting, in this process or in one of its own.

`run` drives an `FmuFile` through a `Setting` and returns the run. The public names stand in
`__init__.pyi`; each is imported at its first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Anybody's curve: a time series of the block from any tool, measured against the exact cycle.

`read_curve` reads a CSV file, `score` judges a curve, `as_json` writes the verdict for machines.
The public names stand in `__init__.pyi`; each is imported at its first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""The stick-slip friction block: its FMU, the theory, verdicts on FMUs and curves, feed axes.

``import stickslip as ss``; each name is imported at its first use. `library` has the functions
that the command is made of; the public names stand in `__init__.pyi`.
"""

import lazy_loader

from stickslip.accessor import register

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

register()

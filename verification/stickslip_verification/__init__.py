"""Verification of the stick-slip block: exact truth, cases as data, two sides, one verdict.

`load_cases` reads the cases, `verify` judges an FMU and the reference on them, `write_report`
writes the report, `lint` checks the suite itself. The public names stand in `__init__.pyi`; each
is imported at its first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

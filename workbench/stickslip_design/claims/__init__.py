"""What designers are told, tried against the exact solution and put into numbers.

`findings` tries every claim, `markdown` and `draw` show the results, `pages` and `write` make the
page and its plots. The public names stand in `__init__.pyi`; each is imported at its first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

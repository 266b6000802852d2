"""A verdict as a page for a design review, as JSON, as tables and as pictures.

`html` makes the page, `data` what goes into JSON; `tables` has the parts in words and `plots` the
pictures. The public names stand in `__init__.pyi`; each is imported at its first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

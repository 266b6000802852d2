"""``dataset.stickslip``, for the datasets of xarray once stickslip is imported, before or after.

xarray itself takes half a second to import, so it is waited for. And figures, in a notebook.
"""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


class Accessor:
    """``dataset.stickslip``, where the dataset is that of a map."""

    def __init__(self, dataset: xarray.Dataset) -> None:
        self._dataset = dataset

    def plot(self) -> Figure:
        """Draw the jump over the first two parameters, further ones as the block or axis has them.

        Raises
        ------
        ValueError
            If the dataset is not that of a map.
        """
        from stickslip_design.maps.page import figure_of

        return figure_of(self._dataset)


class _Waiting:
    """A finder of modules that gives xarray its accessor once it is imported."""

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        if name != "xarray":
            return None
        spec = PathFinder.find_spec(name)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module: ModuleType) -> None:
                execute(module)
                _give(module)

            spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec


def _give(module: Any) -> None:
    module.register_dataset_accessor("stickslip")(Accessor)


def register() -> None:
    """Give the datasets of xarray their `Accessor`, at once or as soon as it is imported."""
    # Else a notebook shows a figure only where pyplot is imported.
    if "IPython" in sys.modules and (shell := sys.modules["IPython"].get_ipython()) is not None:
        draw = import_module("IPython.core.pylabtools").print_figure
        formatter = shell.display_formatter.formatters["image/png"]
        formatter.for_type_by_name("matplotlib.figure", "Figure", draw)
    if "xarray" in sys.modules:
        _give(sys.modules["xarray"])
    else:
        sys.meta_path.insert(0, _Waiting())

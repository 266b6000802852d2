"""The interactive page: one self-contained HTML file, assembled from its sources in this folder."""

from stickslip.page.assemble import page, page_range

__all__ = ["page", "page_range"]

"""Facts about the interactive page, most of them asked of the page in a real browser."""

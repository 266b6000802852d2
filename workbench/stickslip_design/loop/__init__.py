"""The servo loop around a feed axis."""

"""Facts about the design studies."""

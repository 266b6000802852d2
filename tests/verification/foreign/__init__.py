"""Sources of FMUs that are not ours, and what builds them."""

"""Maps: the answers over ranges of two or more parameters."""

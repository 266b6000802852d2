"""Facts about the score of a curve."""

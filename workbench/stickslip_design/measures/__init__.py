"""What a designer can order against juddering: the catalogue, and what it does to an axis."""

"""LuGre: friction of bristles that bend before they slide."""

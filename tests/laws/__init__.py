"""Friction laws that only the tests know."""

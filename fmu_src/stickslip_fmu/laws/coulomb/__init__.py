"""Coulomb's friction law: static above kinetic friction, both constant. docs/theory.md (1)."""

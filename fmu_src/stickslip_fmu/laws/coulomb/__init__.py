"""Coulomb's friction law: static friction, which may grow in stick, above the kinetic one."""

"""Where stick-slip ends, for every friction law."""

from .every_law import critical_velocity

__all__ = ["critical_velocity"]

"""Where stick-slip ends, for every friction law."""

from .every_law import critical_velocity, memory_cycle

__all__ = ["critical_velocity", "memory_cycle"]

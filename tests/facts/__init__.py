"""Facts of the physics, tried on the block, the native FMU, the reference and the truth."""

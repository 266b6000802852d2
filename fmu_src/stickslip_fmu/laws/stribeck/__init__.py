"""Friction over speed as measured: Stribeck's curves and a curve of points, with a true stick."""

"""Numerics that know no friction: compensated sums, a bracketed root, quadrature, finite values."""

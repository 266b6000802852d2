"""What only the reference has: fields, samples, limits."""

"""Random sequences of FMI calls: made, played on the binary, and judged."""

"""One simulation by the FMU or by the reference, as samples and events."""

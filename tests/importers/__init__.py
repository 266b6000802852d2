"""The FMU as simulators other than ours import it."""

"""FMI 2.0: the calls of pythonfmu's wrapper and the model description."""

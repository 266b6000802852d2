"""FMI 3.0: the calls of pythonfmu3's wrapper and the model description."""

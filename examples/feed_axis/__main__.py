"""`python -m examples.feed_axis`."""

from .run import main

main()

"""A feed axis, closed loop: a servo drive as a second FMU that moves the stick-slip block.

docs/feed-axis.md tells how to run it and what comes out.
"""

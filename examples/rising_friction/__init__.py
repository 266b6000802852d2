"""Kinetic friction that rises with speed: a friction law of one's own, a folder to copy.

F_k = (mu_k + rise |x_dot|) N. Block, reference and truth share nothing.
"""

from types import SimpleNamespace

RISING = SimpleNamespace(
    block=f"{__name__}.block:LAW",
    reference=f"{__name__}.reference:LAW",
    truth=f"{__name__}.truth:LAW",
)

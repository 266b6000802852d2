"""A module that needs the project, which it cannot have here."""

import stickslip  # noqa: F401

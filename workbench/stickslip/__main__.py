"""`python -m stickslip`: the command."""

from stickslip.cli import main

main()

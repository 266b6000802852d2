"""Stribeck's law as the module of somebody else brings it: under a dotted name and a model name."""

from types import SimpleNamespace

from stickslip_fmu.laws.stribeck.law import Stribeck

NAME = "tests.laws.renamed:RENAMED"


class Renamed(Stribeck):
    interface = Stribeck.interface._replace(model="RenamedFriction")


LAW = Renamed()
RENAMED = SimpleNamespace(
    block="tests.laws.renamed:LAW",
    reference="stickslip_ref.laws.stribeck:STRIBECK",
    truth="stickslip_verification.truth.stribeck:STRIBECK",
)

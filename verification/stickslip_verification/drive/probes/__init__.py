"""Probes of an FMU as a whole: what it declares and refuses, and how it bears a master's calls.

A probe returns its complaints, one line each; none if the FMU is sound.
"""

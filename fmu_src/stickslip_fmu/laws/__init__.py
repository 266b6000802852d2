"""Friction laws: the protocol, what laws with a stick share, and a folder for each law."""

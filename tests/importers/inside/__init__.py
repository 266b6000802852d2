"""Runs in processes that cannot import the project; see `process.py`."""

"""Tests of the answers for many settings at once."""

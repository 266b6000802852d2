"""The answers to one question for many settings at once, each point exact."""

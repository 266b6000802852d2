"""The release: its number and its date, which everything built from it carries."""

VERSION = "0.1.0"
DATE = "2026-11-21T00:00:00Z"

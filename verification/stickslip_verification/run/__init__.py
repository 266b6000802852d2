"""A verification from beginning to end: suite, drive, judge and report put together."""

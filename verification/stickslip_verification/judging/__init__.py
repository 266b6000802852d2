"""What came of it, judged: pure functions from records to results."""

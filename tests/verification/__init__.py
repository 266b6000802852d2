"""Facts about the verification: its truth, its cases, its checks, its random tests."""

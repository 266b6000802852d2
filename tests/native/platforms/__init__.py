"""The native FMU for all platforms: `make native-platforms` runs these tests, `make test` does not.

They need ziglang (411 MB) and lief, which the extra `native-platforms` brings.
"""

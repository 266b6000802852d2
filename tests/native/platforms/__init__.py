"""The native FMU for all platforms: `make native-platforms` runs these tests, `make test` does not.

They need ziglang (411 MB) and lief, which the extra `native-platforms` brings; what runs the FMU on
Linux ARM64 and Windows needs qemu and Wine.
"""

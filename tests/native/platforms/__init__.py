"""The native FMU for all platforms: `make native-platforms` alone runs these tests."""

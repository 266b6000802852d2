"""Programs that the tests of the native FMU run in processes of their own."""

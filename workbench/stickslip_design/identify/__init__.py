"""From a record of a drive or a pull test to the numbers of an axis, with their intervals."""

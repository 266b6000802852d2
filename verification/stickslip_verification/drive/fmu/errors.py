"""What is said when an FMU cannot be used."""


class FmuError(RuntimeError):
    """The FMU cannot be used or refused a call; one line with what it said itself."""


def one_line(error: BaseException) -> str:
    """Give the text of an error on one line, or its kind if it has none."""
    return " ".join(str(error).split()) or type(error).__name__

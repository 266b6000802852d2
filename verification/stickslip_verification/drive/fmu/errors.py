"""What is said when an FMU cannot be used."""


class FmuError(RuntimeError):
    """The FMU cannot be used, or refused a call; one line, with the FMU's own message if any."""


class NotApplicableError(Exception):
    """The FMU lacks what a case or an invariant needs; the text says what."""


def one_line(error: BaseException) -> str:
    """Return the text of an error on one line, or its kind if it has none."""
    return " ".join(str(error).split()) or type(error).__name__

"""The one kind of error that the command shows to the person who typed it."""


class CommandError(ValueError):
    """What was asked cannot be done; the message is one line that says what, where and why.

    The command prints it on standard error and exits with code 2.
    """

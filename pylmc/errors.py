"""The one exception, and the one warning, that a person is meant to read."""


class PylmcError(Exception):
    """Bad input or a missing capability: the message names the thing, the place and the remedy.

    The command line prints it as one line and exits with code 2; nothing else is caught there.
    """


class PylmcWarning(UserWarning):
    """The result may be wrong, and why: a sentence that names the thing, the place and the remedy (pylmc.sampling.limits)."""

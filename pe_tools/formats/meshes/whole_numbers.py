"""Text that NumPy reads as numbers, to its end."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

UNREAD_TEXT = "string or file could not be read"
"""How the message begins by which NumPy below 2.5 warns of text that is no number; later versions
raise `ValueError`."""


@contextmanager
def refusing_unread_text() -> Iterator[None]:
    """Raise `DeprecationWarning`, or `ValueError`, where NumPy finds text that is no number.

    Other deprecations, of how a library uses NumPy, stay warnings: they concern no file.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=DeprecationWarning)
        warnings.filterwarnings("error", UNREAD_TEXT, DeprecationWarning)
        yield

"""The one exception that means: the user's input is wrong, and here is how to mend it."""

from __future__ import annotations


class InputError(ValueError):
    """Bad input, told in one line.

    Parameters
    ----------
    source : str
        Where the input came from: a file's path, or the name of what was passed in.
    field : str
        Which field of it is wrong (``sensor[0].model``), or what was being read.
    expected : str
        What would have been right.
    found : object
        What was there instead.
    """

    def __init__(self, source: object, field: str, expected: str, found: object) -> None:
        self.source, self.field, self.expected, self.found = str(source), field, expected, found
        line = f"{source}: {field}: expected {expected}, found {found}"
        super().__init__(" ".join(line.split()))

    def at(self, source: object) -> InputError:
        """Return the same error, said of another source (the file a value came from)."""
        return InputError(source, self.field, self.expected, self.found)

"""What a page says of itself: title, author, date and revision."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date

from .engine import pe

TODAY = "today"
"""As a date: the day on which the page is made. Without it the same study gives the same bytes."""
MOST_LETTERS = 200


@dataclass(frozen=True, slots=True)
class About:
    """What stands at the head of a page; what is empty is left out.

    Parameters
    ----------
    title : str
        In place of the studies' names, which then stand below it.
    author, revision : str
    date : str
        As it is to be read ("2026-05-04", "May 2026"); "today" is the day of the run.

    Raises
    ------
    InputError
        When a text is longer than 200 letters.
    """

    title: str = ""
    author: str = ""
    date: str = ""
    revision: str = ""

    def __post_init__(self) -> None:
        for name in ("title", "author", "date", "revision"):
            text = " ".join(str(getattr(self, name)).split())
            if len(text) > MOST_LETTERS:
                expected = f"{MOST_LETTERS} letters at most"
                raise pe.InputError("review", name, expected, f"{len(text)}")
            object.__setattr__(self, name, text)
        if self.date.lower() == TODAY:
            object.__setattr__(self, "date", date.today().isoformat())

    @property
    def line(self) -> str:
        """Author, date and revision in a line."""
        revision = f"Revision {self.revision}" if self.revision else ""
        return ", ".join(filter(None, (self.author, self.date, revision)))

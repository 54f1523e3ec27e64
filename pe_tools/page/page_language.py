"""The page in another language: its finished HTML and its data are translated; figures stay.

The sections write English. Names of studies, sensors, models and parts are the users' own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .. import languages
from .report_context import About, ReportContext, Section

TEXT_KEYS = frozenset({"label", "title", "texts", "classes", "ticks"})
"""Keys of a section's data whose values are texts for the reader."""
NOT_READ = "The translation of this page has not been read by a native reader of the field."


class PageLanguage:
    """The language of a page.

    Parameters
    ----------
    contexts : sequence of ReportContext
    about : About
        `language` is the code of the language.
    """

    def __init__(self, contexts: Sequence[ReportContext], about: About) -> None:
        self.code = about.language
        own = languages.catalog(self.code)
        self._catalog = own.with_names(_names(contexts, about))

    def text(self, text: str) -> str:
        """Return a text in this language."""
        return self._catalog.translated(text)

    def html(self, html: str) -> str:
        """Return HTML with its texts in this language."""
        return languages.translated_html(html, self._catalog) if self._catalog.messages else html

    def section(self, section: Section) -> Mapping[str, Any]:
        """Return a section's data with its texts in this language."""
        return self._data(section.data, False) if self._catalog.messages else section.data

    def _data(self, data: Any, is_text: bool) -> Any:
        if isinstance(data, Mapping):
            return {k: self._data(v, is_text or k in TEXT_KEYS) for k, v in data.items()}
        if isinstance(data, (list, tuple)):
            return [self._data(value, is_text) for value in data]
        return self.text(data) if is_text and isinstance(data, str) else data

    @property
    def note(self) -> str:
        """HTML that says that no native reader has read the translation; empty in English."""
        return f'<p class="note">{self.text(NOT_READ)}</p>' if self._catalog.messages else ""


def _names(contexts: Sequence[ReportContext], about: About) -> set[str]:
    """Return the texts of a page that users have written."""
    names = {about.title, about.author, *(context.name for context in contexts)}
    for context in contexts:
        names |= {sensor.name for sensor in context.rig}
        names |= {sensor.model.name for sensor in context.rig}
        names |= set(() if context.vehicle is None else context.vehicle.part_names)
        names |= {requirement.name for requirement in context.study.requirements}
    return names

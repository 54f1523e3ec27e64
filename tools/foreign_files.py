"""Write docs/foreign_files.md: which files of other programs were read, and the result of files of
the same form."""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tests.engine.foreign_forms import ForeignForm

CHECKOUT = Path(__file__).resolve().parents[1]
PAGE = CHECKOUT / "docs" / "foreign_files.md"
TITLE = "# Files of other programs that were read"
ABOUT = (
    "`python tools/foreign_files.py` writes this page. Each file was opened at the commit that is "
    "named. None is kept here:\nthe result is that of a file of the same form, with the same "
    "structure and names of fields, that the tests make\n(`tests/engine/foreign_forms.py`). What a "
    "reader leaves out or guesses, it says in a message. Of Argoverse 2 the\nfile is the page that "
    "prints its tables, of OSI the definition of its messages."
)
COLUMNS = "| file | format | result of its form | messages |\n| --- | --- | --- | --- |\n"


def page() -> str:
    """Return the text of the page; the libraries of all forms have to be installed."""
    from tests.engine.foreign_forms import FORMS

    rows = "".join(f"{row(form)}\n" for form in FORMS)
    return f"{TITLE}\n\n{ABOUT}\n\n{COLUMNS}{rows}"


def row(form: ForeignForm) -> str:
    """Return the row of a file."""
    with tempfile.TemporaryDirectory() as folder:
        found = form.read(Path(folder))
    kinds = Counter(sensor.kind for sensor in found.rig)
    result = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    url = f"https://github.com/{form.repository}/blob/{form.commit}/{form.path}"
    file = f"[{form.repository}@{form.commit[:7]}]({url}) `{Path(form.path).name}`"
    lines = "<br>".join(found.lines).replace("|", "/") or "none"
    return f"| {file} | `{form.format}` | {result} | {lines} |"


if __name__ == "__main__":
    sys.path.insert(0, str(CHECKOUT))
    PAGE.write_text(page(), encoding="utf-8")

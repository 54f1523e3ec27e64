"""Write docs/foreign_files.md: which files of other programs were read, and the result of files of
the same form."""

import sys
import tempfile
from collections import Counter
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[1]
PAGE = CHECKOUT / "docs" / "foreign_files.md"
TITLE = "# Files of other programs that were read"
ABOUT = (
    "`python tools/foreign_files.py` writes this page. Each file was opened at the commit that is "
    "named. None is kept here:\nthe result is that of a file of the same form, with the same "
    "structure and names of fields, that the tests make\n(`tests/engine/foreign_forms.py`). What a "
    "reader leaves out or guesses, it says in a message."
)
COLUMNS = "| file | format | result of its form | messages |\n| --- | --- | --- | --- |\n"


def page() -> str:
    """Return the text of the page."""
    from tests.engine.foreign_forms import FORMS

    rows = []
    for form in FORMS:
        with tempfile.TemporaryDirectory() as folder:
            found = form.read(Path(folder))
        kinds = Counter(sensor.kind for sensor in found.rig)
        result = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
        url = f"https://github.com/{form.repository}/blob/{form.commit}/{form.path}"
        file = f"[{form.repository}@{form.commit[:7]}]({url}) `{Path(form.path).name}`"
        lines = "<br>".join(found.lines).replace("|", "/") or "none"
        rows.append(f"| {file} | `{form.format}` | {result} | {lines} |\n")
    return f"{TITLE}\n\n{ABOUT}\n\n{COLUMNS}{''.join(rows)}"


if __name__ == "__main__":
    sys.path.insert(0, str(CHECKOUT))
    PAGE.write_text(page(), encoding="utf-8")

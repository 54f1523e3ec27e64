"""Everything needed to run it again."""

from __future__ import annotations

import platform

import numpy as np

from ..engine import advice, pe, studies
from ..markup import Markup, escaped, table
from ..reviewed import Reviewed
from ..section import Section

COPY = """
for (const button of document.querySelectorAll("button[data-copies]")) {
  button.hidden = false;
  button.addEventListener("click", async () => {
    const text = document.getElementById(button.dataset.copies);
    const range = document.createRange();
    range.selectNodeContents(text);
    const chosen = window.getSelection();
    chosen.removeAllRanges();
    chosen.addRange(range);
    try { await navigator.clipboard.writeText(text.textContent); button.textContent = "Copied"; }
    catch { button.textContent = document.execCommand("copy") ? "Copied" : "Selected"; }
  });
}
"""


def again(one: Reviewed) -> Section:
    """Return command line, versions, digests and the study itself."""
    return Section(
        "again", "Run it again", f"{_command(one)}{_facts(one)}{_study(one)}", {}, (COPY,)
    )


def _command(one: Reviewed) -> str:
    """The command line as it was given, and one that needs nothing but the study below."""
    by = f"<p>It is made again, where its files are, by</p><pre>{escaped(one.command)}</pre>"
    given = by if one.command else ""
    lines = "pe optimize study.toml -o DIR" if one.searched else "pe review study.toml -o DIR"
    return (
        f"{given}<p>With the study below saved as study.toml, and the files it names beside it:</p>"
        f"<pre>{lines}</pre>"
    )


def _facts(one: Reviewed) -> str:
    found = one.found
    rows = [
        ["perception-entropy", pe.__version__],
        ["Python, NumPy", f"{platform.python_version()}, {np.__version__}"],
        *([name, version] for name, version in one.versions.items()),
        ["Scored on", _looked_at(one)],
        *([["Seed", str(one.asked.search.seed)]] if one.searched else []),
        ["Study as given, SHA-256", _digest(studies.fingerprint(one.asked))],
        ["Vehicle", found.vehicle_line or "none: nothing hides anything"],
        ["Vehicle, SHA-256", _digest(studies.vehicle_digest(one.vehicle) or "")],
    ]
    return table("What it was made with", ("what", "which"), rows, css="words")


def _looked_at(one: Reviewed) -> str:
    score, space = one.after, one.found.space
    if score.objects is not None:
        looked = advice.objects_looked_at(score.objects)
        return f"{looked}, standard error {score.stderr:.4f} nats"
    every = "all " if not score.stderr else "a sample of "
    error = f", standard error {score.stderr:.4f} nats" if score.stderr else ""
    return f"{every}{score.voxels:,} voxels, of {space.interval:g} m{error}"


def _digest(text: str) -> str | Markup:
    return Markup(f"<code>{escaped(text)}</code>") if text else "none"


def _study(one: Reviewed) -> str:
    """The study as it was given, from which the run follows; of a search the one found, too."""
    if not one.searched:
        return _text(one.asked, f"study-{one.key}", "The study")
    given = _text(one.asked, f"study-{one.key}", "The study as it was given")
    return given + _text(one.found, f"found-{one.key}", "The study with the places that were found")


def _text(study: pe.Study, name: str, title: str) -> str:
    """Return a study's file with a button that copies it."""
    text = studies.study_writers(study, studies.STUDY)[studies.STUDY]
    assert isinstance(text, bytes)
    return (
        f'<h3>{title}</h3><button type="button" data-copies="{name}" hidden>Copy</button>'
        f'<pre id="{name}" tabindex="0">{escaped_lines(text.decode())}</pre>'
    )


def escaped_lines(text: str) -> str:
    """Return a text of several lines as HTML."""
    return "\n".join(escaped(line) for line in text.split("\n"))

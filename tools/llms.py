#!/usr/bin/env python3
"""Write llms.txt: what this is, and the pages of the documentation, for programs that read.

The pages are those of the navigation in mkdocs.yml, each with its first sentence. A test holds the
file to what is made here.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

from docs_site import outside  # noqa: E402

FILE = ROOT / "llms.txt"
HEAD = """# Perception Entropy

> Scores and optimizes where LiDARs, cameras, radars and ultrasonic sensors sit on a vehicle, by
> perception entropy (Ma, Liu and Li, ICRA 2021): a metric, a command `pe`, a Python library, a
> Blender extension. GPL-3.0-or-later.

Begin with [AGENTS.md](AGENTS.md): how to score, search, check and export in five calls, what the
figures mean, what not to conclude.
"""
SECTION = re.compile(r"^  - ([\w ]+):$")
PAGE = re.compile(r'^      - (?:"?([^":]*(?:: [^":]*)?)"?: )?([\w/]+\.md)$')
NO_TEXT = ("#", "```", "|", "!", "<", "-", ">", "[", "---")
"""Beginnings of lines that are no sentence."""
MIN_SENTENCE = 25
MAX_SENTENCE = 160
"""Characters of a sentence that says something, and of one that is short enough."""


def pages() -> Iterator[tuple[str, str, Path]]:
    """Yield section, title and file of each page in the navigation that is in the checkout."""
    section = ""
    real = {site: name for name, site in outside.PAGES.items()}
    for line in (ROOT / "mkdocs.yml").read_text("utf-8").partition("\nnav:\n")[2].splitlines():
        if found := SECTION.match(line):
            section = found[1]
        elif found := PAGE.match(line):
            path = ROOT / real.get(found[2], f"docs/{found[2]}")
            if path.exists():
                yield section, found[1] or outside.title_of(path), path


def first_sentence(text: str) -> str:
    """Return the first sentence of a page, without links and emphasis; empty if it says nothing."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    blocks = (block.strip() for block in text.split("\n\n"))
    plain = next((block for block in blocks if block and not block.startswith(NO_TEXT)), "")
    plain = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", " ".join(plain.split())).replace("*", "")
    sentence = re.split(r"(?<=[.?!])\s(?=[A-Z`])", plain)[0].rstrip(":")
    return sentence if MIN_SENTENCE <= len(sentence) <= MAX_SENTENCE else ""


def text() -> str:
    """Return the whole file."""
    lines = [HEAD]
    section = ""
    for of, title, path in pages():
        if of != section:
            section = of
            lines.append(f"\n## {section}\n\n")
        about = first_sentence(path.read_text("utf-8"))
        link = f"- [{title}]({path.relative_to(ROOT).as_posix()})"
        lines.append(f"{link}: {about}\n" if about else f"{link}\n")
    return "".join(lines)


if __name__ == "__main__":
    FILE.write_text(text(), "utf-8")

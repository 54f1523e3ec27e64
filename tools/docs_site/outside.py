"""Pages from outside of docs/, and links between them and the pages of docs/."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

PAGES = {
    "CHANGELOG.md": "project/changelog.md",
    "ARCHITECTURE.md": "project/architecture.md",
    "CONTRIBUTING.md": "project/contributing.md",
    "SECURITY.md": "project/security.md",
    "AGENTS.md": "project/agents.md",
    "benchmarks/README.md": "project/benchmarks.md",
    "blend_assets/README.md": "project/vehicles.md",
}
"""Pages that stand beside the code, and where the site has them."""
FILES = {
    f"studies/detectors/plans/{plan}.toml": f"validity/own/plans/{plan}.toml"
    for plan in ("lidars", "cameras", "after_search", "second", "frames")
}
"""Other files outside of docs/ that pages link to, and where the site has them."""
_LINK = re.compile(r"\[([^][]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
_FILE_NAME = re.compile(r"(docs/)?[\w/]+\.md")
"""A link whose text is the name of a file has the title of its page instead."""
_CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def with_site_links(markdown: str, page: str) -> str:
    """Return a page's text with links to where the site has their targets.

    Parameters
    ----------
    markdown : str
    page : str
        The page in the site, as in ``project/changelog.md``.
    """
    source = {site: real for real, site in PAGES.items()}.get(page, f"docs/{page}")
    folder = posixpath.dirname(source)
    site_folder = posixpath.dirname(page)

    def in_site(found: re.Match[str]) -> str:
        text, target, anchor = found.groups()
        if re.match(r"\w+:", target):
            return found[0]
        real = posixpath.normpath(posixpath.join(folder, target))
        wanted = in_site_at(real)
        if wanted is None:  # code: the site does not have it
            return text if (ROOT / real).exists() else found[0]
        if _FILE_NAME.fullmatch(text) and (ROOT / real).exists():
            text = title_of(ROOT / real)
        if source in PAGES or not real.startswith("docs/"):
            target = posixpath.relpath(wanted, site_folder or ".")
        return f"[{text}]({target}{anchor or ''})"

    return _outside_code(markdown, lambda text: _LINK.sub(in_site, text))


def in_site_at(real: str) -> str | None:
    """Return where the site has a file of the checkout; None if it does not."""
    if real.startswith("docs/"):
        return real.removeprefix("docs/")
    if re.fullmatch(r"examples/\w+/review\.html", real):
        return real
    return PAGES.get(real) or FILES.get(real)


def title_of(page: Path) -> str:
    """Return the first heading of a page."""
    return page.read_text("utf-8").partition("# ")[2].partition("\n")[0]


def _outside_code(markdown: str, change) -> str:
    """Change the text between code blocks alone."""
    parts = []
    last = 0
    for block in _CODE.finditer(markdown):
        parts += [change(markdown[last : block.start()]), block[0]]
        last = block.end()
    return "".join([*parts, change(markdown[last:])])

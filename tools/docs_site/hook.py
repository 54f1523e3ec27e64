"""The hook of MkDocs: adds generated pages, and leads links to where the site has their targets."""

from __future__ import annotations

import functools
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

from mkdocs.structure.files import File, Files  # noqa: E402

from docs_site import catalogue, commands, notebook, outside, python_names  # noqa: E402

GENERATED_FOLDERS = {"Catalogue of sensors": catalogue.FOLDER, "Python names": python_names.FOLDER}
"""Entries of the navigation whose pages are generated."""


LAST = "Explanation"
"""The section whose last pages are those of docs/ that mkdocs.yml does not name."""
WIDE = ("requirements.md", "known_rigs.md", "validity/road/README.md")
"""Pages without a table of contents at the right, because their tables are wide."""


def on_config(config):
    """Give the generated pages their places in the navigation."""
    contents = generated()
    for section in config.nav:
        entries = next(iter(section.values()))
        for entry in entries if isinstance(entries, list) else ():
            title = next(iter(entry)) if isinstance(entry, dict) else ""
            if title in GENERATED_FOLDERS:
                entry[title] = pages_in(GENERATED_FOLDERS[title], contents)
    explanation = next(each for each in config.nav if LAST in each)
    explanation[LAST] += unnamed_pages(str(config.nav))
    return config


def unnamed_pages(nav: str) -> list[str]:
    """Return the pages of docs/ itself that the navigation does not name."""
    return sorted(path.name for path in (ROOT / "docs").glob("*.md") if f"'{path.name}'" not in nav)


def pages_in(folder: str, contents: dict[str, str]) -> list[str]:
    """Return the pages of a folder, its first page in front."""
    pages = [path for path in contents if path.startswith(f"{folder}/") and path.endswith(".md")]
    return sorted(pages, key=lambda path: not path.endswith("/index.md"))


def on_files(files: Files, config) -> Files:
    """Add pages from outside of docs/, and those that are generated from the code."""
    for source, page in outside.PAGES.items():
        text = (ROOT / source).read_text("utf-8")
        files.append(File.generated(config, page, content=text))
    for source, path in outside.FILES.items():
        files.append(File.generated(config, path, abs_src_path=str(ROOT / source)))
    for path in sorted((ROOT / "examples").glob("*/review.html")):
        page = f"examples/{path.parent.name}/{path.name}"
        files.append(File.generated(config, page, abs_src_path=str(path)))
    for path, content in generated().items():
        files.append(File.generated(config, path, content=content))
    return files


@functools.cache
def generated() -> dict[str, str]:
    """Return the content of each generated page and picture, by its path."""
    own = {commands.PATH: commands.page(), notebook.NOTEBOOK: notebook.notebook()}
    return {**own, **python_names.pages(), **catalogue.pages()}


def on_page_markdown(markdown: str, page, config, files) -> str:
    """Lead links to where the site has their targets; give wide tables the room of the page."""
    if page.file.src_uri in WIDE:
        page.meta.setdefault("hide", ["toc"])
    if page.file.src_uri == notebook.PAGE:
        markdown = notebook.on_site(markdown)
    return outside.with_site_links(markdown, page.file.src_uri)

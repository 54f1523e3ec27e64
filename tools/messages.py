#!/usr/bin/env python3
"""List what the catalogues of the panel, ``blender_addon/languages/*.po``, lack.

Messages are the names that Blender looks up (labels of operators and panels, properties, items of
menus) and the short labels that the code draws. ``--update`` writes the files anew: new messages
untranslated, messages that no longer exist left out. It needs bpy (``make test`` installs it).
"""

import argparse
import ast
import functools
import json
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT)]

import blender_addon  # noqa: E402
from blender_addon import language, translation_context  # noqa: E402

DRAWN = {"draw_label": 1, "shown": 0}
"""Functions that draw a text, and which of their arguments it is."""
MAX_LETTERS = 40
"""A longer text is a sentence, and stays English."""


def names() -> Iterator[str]:
    """Yield the names of all that is registered."""
    for cls in blender_addon.CLASSES:
        yield from translation_context.names_of(cls)


def labels(path: Path) -> Iterator[str]:
    """Yield the literal labels that a module draws."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if not isinstance(node, ast.Call):
            continue
        called = getattr(node.func, "attr", getattr(node.func, "id", ""))
        values = [keyword.value for keyword in node.keywords if keyword.arg == "text"]
        values += node.args[DRAWN[called] :][:1] if called in DRAWN else []
        for value in values:
            choices = (value.body, value.orelse) if isinstance(value, ast.IfExp) else (value,)
            texts = (choice.value for choice in choices if isinstance(choice, ast.Constant))
            yield from (text for text in texts if isinstance(text, str))


def messages() -> list[str]:
    """Return all messages, sorted."""
    files = [path for path in (ROOT / "blender_addon").rglob("*.py")]
    found = {*names(), *(text for path in files for text in labels(path))}
    return sorted(text for text in found if any(map(str.isalpha, text)) and is_label(text))


def is_label(text: str) -> bool:
    """Whether a text is a name or a short label, and no sentence."""
    return len(text) <= MAX_LETTERS and ". " not in text


def po_text(code: str, translations: dict[str, str]) -> str:
    """Return a .po file of all messages, with the translations that there are."""
    header = (
        f"# Perception entropy for Blender, {language.LANGUAGES[code]}: names and labels.\n"
        "# Not yet read by a native speaker of the field: one is wanted.\n"
        f'msgid ""\nmsgstr ""\n"Language: {code}\\n"\n'
        '"Content-Type: text/plain; charset=UTF-8\\n"\n'
    )
    quoted = functools.partial(json.dumps, ensure_ascii=False)
    rows = ((quoted(text), quoted(translations.get(text, ""))) for text in messages())
    return header + "".join(f"\nmsgid {text}\nmsgstr {to}\n" for text, to in rows)


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--update", action="store_true", help="write the .po files anew")
    is_update = parser.parse_args().update
    for code in language.LANGUAGES:
        translations = language.catalog(code)
        if is_update:
            (language.FOLDER / f"{code}.po").write_text(po_text(code, translations), "utf-8")
        missing = [text for text in messages() if text not in translations]
        print(*(f"{code}: {text}" for text in missing), sep="\n")
    print(f"messages: {len(messages())}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

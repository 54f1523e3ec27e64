#!/usr/bin/env python3
"""Compare the texts of the code with the catalogues of languages, ``pe_tools/languages/*.po``.

Texts are found in the syntax trees: labels, tooltips, enum items, reports, sentences. A composed
sentence is a message with placeholders, named after the expressions in the code. Without an option
the messages that a language lacks are listed, and those that the code no longer has; exit status 1
when there is any. ``--update`` adds the first to the .po files, untranslated, and removes the
others.
"""

import argparse
import ast
import functools
import itertools
import json
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT)]

from pe_tools import languages  # noqa: E402

SHOWN = ("blender_addon", "pe_tools/advice", "pe_tools/graphics", "pe_tools/page")
NOT_SHOWN = ("blender_addon/commands", "blender_addon/__main__.py", "pe_tools/page/__init__.py")
"""Their texts are those of the command line, which is English."""
DECLARED = "pe_core"
DECLARATIONS = {"setting", "required_setting", "Panel", "Method", "Kind", "Body", "Criterion"}
"""Calls in the engine whose texts the interface shows."""
PRESETS = "pe_core/scoring/requirements/presets.toml"
RULES = ROOT / "tools" / "messages.json"
"""Short words that are messages, texts that look like messages and are none, and more messages."""
WORDS = re.compile(r"[A-Za-z][A-Za-z']+[,:;.]? [^\s]")
CAPITAL = re.compile(r"[A-Z][a-z]+(-[a-z]+)?")
PLAIN = re.compile(r"[\w.\-/:#\[\]]+")
MAX_VARIANTS = 16
CODE = "\n\n"
"""Stands in a text for a brace: such a text is a style sheet or a script."""
TAG = re.compile(r"<[^<>]*>")


@functools.cache
def rules() -> dict:
    """Return the rules of what is a message."""
    return json.loads(RULES.read_text("utf-8"))


def looks_like_text(text: str) -> bool:
    """Whether a string of the code is a text for the user, by its form."""
    if text in rules()["words"]:
        return True
    plain = TAG.sub("", languages.PLACEHOLDER.sub("0", text)).strip()
    if "\n" in text:
        return False
    return bool(WORDS.search(plain) or CAPITAL.fullmatch(plain))


def variants(node: ast.expr) -> list[str] | None:
    """Return the messages of a string in the code: one for each way of its conditions."""
    if isinstance(node, ast.Constant):
        return [node.value] if isinstance(node.value, str) else None
    if isinstance(node, ast.IfExp):
        both = variants(node.body), variants(node.orelse)
        return None if None in both else [*both[0], *both[1]]
    if not isinstance(node, ast.JoinedStr):
        return None
    parts = []
    for value in node.values:
        if isinstance(value, ast.FormattedValue):
            inner = None if value.format_spec else variants(value.value)
            parts.append(inner or [value.value])
        else:
            parts.append([value.value.replace("{", CODE)])
    if len(list(itertools.product(*parts))) > MAX_VARIANTS:
        parts = [p if len(p) == 1 else [node.values[k].value] for k, p in enumerate(parts)]
    return [_named(choice) for choice in itertools.product(*parts)]


def _named(parts: tuple[str | ast.expr, ...]) -> str:
    """Put a message together; its placeholders are named after the expressions."""
    text, used = "", {}
    for part in parts:
        if isinstance(part, str):
            text += part
            continue
        name = name_of(part)
        used[name] = used.get(name, 0) + 1
        text += f"{{{name}{used[name] if used[name] > 1 else ''}}}"
    return text


def name_of(node: ast.expr) -> str:
    """Return a name for a placeholder: the last identifier of an expression."""
    if isinstance(node, ast.Name):
        return node.id.strip("_").lower() or "value"
    if isinstance(node, ast.Attribute):
        return node.attr.strip("_").lower()
    if isinstance(node, ast.Call):
        if name_of(node.func) == "plural":
            return "count"
        return name_of(node.args[0]) if node.args else name_of(node.func)
    for inner in ("value", "left", "operand", "elt", "body", "test"):
        if isinstance(getattr(node, inner, None), ast.expr):
            return name_of(getattr(node, inner))
    return "value"


def strings_of(tree: ast.AST) -> Iterator[ast.expr]:
    """Yield the outermost strings of a syntax tree but for docstrings and annotations."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            continue
        if isinstance(node, ast.JoinedStr) or (
            isinstance(node, ast.Constant) and isinstance(node.value, str)
        ):
            yield node
            for value in getattr(node, "values", ()):
                if isinstance(value, ast.FormattedValue):
                    yield from strings_of(value)
        else:
            yield from strings_of(node)


def tooltips(tree: ast.Module) -> Iterator[str]:
    """Yield the docstrings of classes that Blender shows as tooltips."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and re.match(r"PE_(OT|MT|PT)_", node.name):
            text = ast.get_docstring(node)
            yield " ".join((text or "").split("\n\n")[0].split())


def nouns(tree: ast.AST) -> Iterator[str]:
    """Yield the messages of counted nouns: "{count} sensor", "{count} sensors"."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and name_of(node.func) == "plural" and len(node.args) > 1:
            for noun in variants(node.args[1]) or ():
                yield from (f"{{count}} {noun}", f"{{count}} {noun}s")


def messages_of(path: Path) -> Iterator[str]:
    """Yield the messages of a module."""
    tree = ast.parse(path.read_text("utf-8"))
    name = path.relative_to(ROOT).as_posix()
    yield from nouns(tree)
    if name.startswith(DECLARED):
        calls = (node for node in ast.walk(tree) if isinstance(node, ast.Call))
        trees = [node for node in calls if name_of(node.func) in {d.lower() for d in DECLARATIONS}]
        for call in trees:
            yield from _texts(strings_of(call))
        return
    yield from tooltips(tree)
    yield from _texts(strings_of(tree))


def _texts(strings: Iterator[ast.expr]) -> Iterator[str]:
    for node in strings:
        for message in variants(node) or ():
            texts = languages.texts_of(message) if "<" in message else [message]
            yield from (text.strip() for text in texts if looks_like_text(text.strip()))


def messages() -> dict[str, str]:
    """Return all messages, each with the module that it is first found in."""
    found: dict[str, str] = {}
    paths = [path for room in (*SHOWN, DECLARED) for path in sorted((ROOT / room).rglob("*.py"))]
    for path in paths:
        name = path.relative_to(ROOT).as_posix()
        if "_vendor" not in path.parts and not name.startswith(NOT_SHOWN):
            for message in messages_of(path):
                found.setdefault(message, name)
    for preset in tomllib.loads((ROOT / PRESETS).read_text("utf-8")).values():
        for text in _preset_texts(preset):
            found.setdefault(text, PRESETS)
    for message in rules()["more"]:
        found.setdefault(message, "tools/messages.json")
    for message in rules()["not_messages"]:
        found.pop(message, None)
    return {text: name for text, name in found.items() if text}


def _preset_texts(preset: object) -> Iterator[str]:
    if isinstance(preset, dict):
        yield from (preset[key] for key in ("name",) if key in preset)
        for value in preset.values():
            yield from _preset_texts(value)
    elif isinstance(preset, list):
        for value in preset:
            yield from _preset_texts(value)


def problems(language: str, found: dict[str, str]) -> Iterator[str]:
    """Yield what is wrong with a language: missing, dangling, and other placeholders."""
    translations = languages.read_po(languages.FOLDER / f"{language}.po")
    for message in found.keys() - translations.keys():
        yield f"{language}: missing: {message!r} ({found[message]})"
    for message in translations.keys() - found.keys():
        yield f"{language}: dangling: {message!r}"
    for message, translation in translations.items():
        holes, filled = (sorted(languages.placeholders(text)) for text in (message, translation))
        if holes != filled:
            yield f"{language}: placeholders {filled} in place of {holes}: {message!r}"


def po_text(language: str, found: dict[str, str], translations: dict[str, str]) -> str:
    """Return a .po file: the messages by module, with their translations."""
    header = (
        f"# Perception entropy for Blender, {languages.LANGUAGES[language]}.\n"
        "# Made with the terms of the field, and not yet read by a native speaker: a native\n"
        "# reader of the field is wanted. Remove X-Native-Reader's line after such a reading.\n"
        '#\nmsgid ""\nmsgstr ""\n'
        f'"Language: {language}\\n"\n'
        '"Content-Type: text/plain; charset=UTF-8\\n"\n'
        '"X-Native-Reader: needed\\n"\n'
    )
    order = sorted(found, key=lambda message: (found[message], message))
    blocks = [
        f"\n#: {found[m]}\n{'#, python-brace-format' + chr(10) if '{' in m else ''}"
        f"msgid {_quoted(m)}\nmsgstr {_quoted(translations.get(m, ''))}\n"
        for m in order
    ]
    return header + "".join(blocks)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def update() -> None:
    """Write the .po files anew: messages of the code, with the translations that there are."""
    found = messages()
    for language in languages.LANGUAGES:
        path = languages.FOLDER / f"{language}.po"
        translations = languages.read_po(path) if path.exists() else {}
        path.write_text(po_text(language, found, translations), "utf-8")


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--update", action="store_true", help="write the .po files anew")
    if parser.parse_args().update:
        update()
    found = messages()
    listed = [line for language in languages.LANGUAGES for line in problems(language, found)]
    print(*listed, f"messages: {len(found)}", sep="\n")
    return bool(listed)


if __name__ == "__main__":
    sys.exit(main())

"""YAML of other programs: read with ruamel.yaml, and edited where keys and values stand. Aliases
are refused: a few lines of them can unfold to gigabytes. The library is imported when a file is
read, not with this module."""

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import NUMBER

KeyPath = tuple[str, ...]
"""Keys of nested mappings, the outermost first; items of a list have their number as key."""
MAX_LENGTH = 1 << 18
"""Maximum characters of a file: kits and lists of lasers have some ten thousand."""
WORDS = {"bool": {"true": True, "false": False}, "null": {}}
TAG = "tag:yaml.org,2002:"


class YamlText:
    """A YAML text with its plain `data`; an edited copy keeps every byte that is not edited. `data`
    are nested dicts and lists of texts, numbers (float), booleans and None. A text that is no YAML,
    no mapping, too long or too deep, has a key twice or aliases raises `InputError`."""

    def __init__(self, source: str, text: str) -> None:
        self.source = source
        self.text = text
        self._nodes: dict[KeyPath, tuple[Any, Any]] = {}
        self._seen: set[int] = set()
        if len(text) > MAX_LENGTH:
            expected = f"YAML of at most {MAX_LENGTH:,} characters"
            raise InputError(source, "file", expected, f"{len(text):,}")
        try:
            root = self._composed()
            self.data: dict[str, Any] = {} if root is None else self._plain(root, ())
        except RecursionError:
            raise InputError(source, "file", "YAML", "too many levels") from None
        if not isinstance(self.data, dict):
            raise InputError(source, "file", "a mapping", shown(self.data))

    def _composed(self) -> Any:
        from ruamel.yaml import YAML
        from ruamel.yaml.error import MarkedYAMLError, YAMLError

        text = self.text
        if text.startswith("%YAML"):  # OpenCV writes it without a blank before the version
            text = "#" + text[1:]
        try:
            with warnings.catch_warnings():  # of an anchor that stands twice
                warnings.simplefilter("ignore")
                return YAML(typ="safe", pure=True).compose(text)
        except MarkedYAMLError as error:
            mark = error.problem_mark
            field = "file" if mark is None else f"line {mark.line + 1}"
            found = str(error.problem or error).removeprefix("found ")
            raise InputError(self.source, field, "well-formed YAML", found) from None
        except (YAMLError, ValueError) as error:
            raise InputError(self.source, "file", "well-formed YAML", error) from None

    def _plain(self, node: Any, path: KeyPath) -> Any:
        """Return the data of a node, and note where the keys and values below it are."""
        where = f"line {node.start_mark.line + 1}"
        if id(node) in self._seen:
            raise InputError(self.source, where, "YAML without aliases", "an alias")
        self._seen.add(id(node))
        if isinstance(node.value, str):
            return _scalar(node)
        is_table = node.id == "mapping"
        pairs = node.value if is_table else [(None, item) for item in node.value]
        data: dict[str, Any] = {}
        for number, (key, value) in enumerate(pairs):
            name = str(number) if key is None else key.value
            if not isinstance(name, str) or name in data:
                line = f"line {key.start_mark.line + 1}"
                found = shown(name) if isinstance(name, str) else "a list or a mapping"
                raise InputError(self.source, line, "a key used once", found)
            self._nodes[(*path, name)] = key, value
            data[name] = self._plain(value, (*path, name))
        return data if is_table else list(data.values())

    def comments(self) -> dict[KeyPath, str]:
        """Return the comments after keys of mappings, on the key's line, by path."""
        return {p: c for p in self._nodes if (c := self._comment(p)[1])}

    def _comment(self, path: KeyPath) -> tuple[int, str]:
        """Return where the comment of a mapping's key begins or would begin, and the comment: it is
        on the key's line, after a value in braces. The place is 0 where none can be."""
        key, value = self._nodes[path]
        if key is None or isinstance(value.value, str):
            return 0, ""
        if value.start_mark.line != key.end_mark.line:
            start = self.text.index(":", key.end_mark.index) + 1
        elif value.end_mark.line == key.end_mark.line:
            start = value.end_mark.index
        else:
            return 0, ""
        before, _, comment = self.text[start : self._end_of_line(start)].partition("#")
        return (0, "") if before.strip() else (start + len(before), comment.strip())

    def _end_of_line(self, start: int) -> int:
        end = self.text.find("\n", start)
        return len(self.text) if end < 0 else end

    def edited(
        self,
        values: Mapping[KeyPath, str],
        comments: Mapping[KeyPath, str],
        added: tuple[KeyPath, Sequence[str]] | None = None,
    ) -> str:
        """Return the text with other values and comments, and lines added to a mapping. An empty
        comment removes the old one. The lines of `added` are indented as the keys of the mapping at
        its path."""
        edits = []
        for path, new in values.items():
            value = self._nodes[path][1]
            edits.append((value.start_mark.index, value.end_mark.index, new))
        for path, comment in comments.items():
            start, old = self._comment(path)
            if old:
                end = self._end_of_line(start)
                new = f"# {comment}"
                if not comment:
                    start = len(self.text[:start].rstrip(" \t"))
                    new = ""
                edits.append((start, end, new))
            elif start and comment:
                end = len(self.text[:start].rstrip(" \t\r"))
                edits.append((end, end, f"  # {comment}"))
        if added is not None and added[1]:
            path, lines = added
            if self._nodes[path][1].flow_style:
                expected = "a mapping with a line for each key, to add some"
                raise InputError(self.source, ".".join(path), expected, "one in braces")
            inside = [(key, value) for p, (key, value) in self._nodes.items() if p[:-1] == path]
            leaves = [v for p, (_, v) in self._nodes.items() if p[: len(path)] == path]
            last = max(v.end_mark.index for v in leaves if isinstance(v.value, str))
            end = self._end_of_line(last)
            indent = " " * inside[0][0].start_mark.column
            edits.append((end, end, "".join(f"\n{indent}{line}" for line in lines)))
        text = self.text
        for start, end, new in sorted(edits, reverse=True):
            text = text[:start] + new + text[end:]
        return text


def parse_yaml(source: str, text: str) -> dict[str, Any]:
    """Return the data of a YAML text as nested dicts and lists; see `YamlText`."""
    return YamlText(source, text).data


def _scalar(node: Any) -> Any:
    sort = str(node.tag).removeprefix(TAG)
    text = node.value
    if sort in WORDS:
        return WORDS[sort].get(text.lower())
    return float(text) if not node.style and NUMBER.fullmatch(text) else text

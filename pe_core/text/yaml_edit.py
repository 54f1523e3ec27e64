"""Values of a YAML file replaced where they stand: comments, order and layout stay."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from .yaml_blocks import LINE, PLAIN_REST, unquoted

KeyPath = tuple[str, ...]


def with_values(text: str, values: Mapping[KeyPath, str]) -> str:
    """Return a text with the values at some paths replaced; other bytes stay.

    Parameters
    ----------
    text : str
        Nested ``key: value`` lines, such as `parse_yaml_blocks` takes.
    values : mapping of path to str
        New values by their keys from the outermost on. A path that is not there changes nothing.
    """
    return "".join(
        _replaced(line, values[path]) if path in values else line for path, line in _lines(text)
    )


def comments_of(text: str) -> dict[KeyPath, str]:
    """Return the comments behind keys that have no value, by their paths."""
    return {
        path: line.partition("#")[2].strip()
        for path, line in _lines(text)
        if path and _opens_block(line) and "#" in line
    }


def with_comments(text: str, comments: Mapping[KeyPath, str]) -> str:
    """Return a text with other comments behind keys that have some; an empty one takes it away."""
    done = []
    for path, line in _lines(text):
        if path in comments and _opens_block(line):
            key, mark, old = line.partition("#")
            end = old[len(old.rstrip("\r\n")) :]
            if mark:
                more = f"# {comments[path]}" if comments[path] else ""
                line = (key + more).rstrip() + end
        done.append(line)
    return "".join(done)


def _opens_block(line: str) -> bool:
    """Whether a line is a key without a value, and not one whose name has a hash in quotes."""
    found = LINE.match(line.rstrip())
    rest = PLAIN_REST.match(found["rest"]) if found else None
    if found is None or rest is None or "#" in found["key"]:
        return False
    return rest["value"] is None


def with_more_lines(text: str, path: KeyPath, more: Sequence[str]) -> str:
    """Return a text with further lines at the end of the block at a path.

    `more` are indented against the block's own keys; the block is not empty.
    """
    lines = list(_lines(text))
    inside = [k for k, (own, _) in enumerate(lines) if own[: len(path)] == path and own]
    first = next(k for k in inside if len(lines[k][0]) > len(path))
    indent = lines[first][1][: len(lines[first][1]) - len(lines[first][1].lstrip())]
    texts = [line for _, line in lines]
    last = inside[-1]
    end = "\r\n" if texts[first].endswith("\r\n") else "\n"
    texts[last] = texts[last].rstrip("\r\n") + end
    return "".join(
        [*texts[: last + 1], *(indent + line + end for line in more), *texts[last + 1 :]]
    )


def _lines(text: str) -> Iterator[tuple[KeyPath, str]]:
    """Yield each line with the path of its key; comments and empty lines have no path."""
    levels: list[tuple[int, str]] = []
    for line in text.splitlines(keepends=True):
        bare, found = line.strip(), LINE.match(line.rstrip())
        if not bare or bare.startswith(("#", "---", "%YAML")) or found is None:
            yield (), line
            continue
        blanks = len(found["blanks"])
        while levels and levels[-1][0] >= blanks:
            levels.pop()
        levels.append((blanks, unquoted(found["key"])))
        yield tuple(key for _, key in levels), line


def _replaced(line: str, value: str) -> str:
    """Return a line with another value; its comment stays."""
    found = LINE.match(line.rstrip())
    rest = PLAIN_REST.match(found["rest"]) if found else None
    if found is None or rest is None or rest["value"] is None:
        return line
    start, end = (found.start("rest") + place for place in rest.span("value"))
    old = line[start:end]
    return line[:start] + value + old[len(old.rstrip()) :] + line[end:]

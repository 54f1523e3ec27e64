"""What pycollada takes without a word and we do not: checked on the XML that it has read."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pe_core.errors import InputError, shown

UP = {"X_UP": "+x", "Y_UP": "+y", "Z_UP": "+z"}
MAX_NODES = 200_000
"""Of a scene, instanced nodes counted each time."""


def check_document(source: str, root: Any) -> None:
    """Check up axis, unit, accessors and the number of nodes of a document's XML root.

    Raises
    ------
    InputError
        A word or a number that is none, an accessor that reaches beyond its data, instanced nodes
        in a circle or more than `MAX_NODES`.
    """
    for up in _each(root, "up_axis"):
        if (up.text or "").strip() not in UP:
            raise InputError(source, "up_axis", f"one of {', '.join(UP)}", shown(up.text))
    for unit in _each(root, "unit"):
        metres = unit.get("meter", "1")
        if _number(metres) is None:
            raise InputError(source, "unit", "its length in metres", shown(metres))
    for geometry in _each(root, "geometry"):
        _check_accessors(source, geometry)
    _check_nodes(source, root)


def _check_accessors(source: str, root: Any) -> None:
    sizes = {
        array.get("id"): len((array.text or "").split()) for array in _each(root, "float_array")
    }
    for accessor in _each(root, "accessor"):
        size = sizes.get((accessor.get("source") or "").removeprefix("#"))
        width = len(list(_each(accessor, "param")))
        if size is None or not width:  # of names, or one that pycollada refuses
            continue
        stride, count, offset = (
            _number(accessor.get(key, default))
            for key, default in (("stride", "1"), ("count", "0"), ("offset", "0"))
        )
        if stride != width or offset != 0:
            expected = f"a stride of its {width} params and no offset"
            found = f"{accessor.get('stride')}, {accessor.get('offset', '0')}"
            raise InputError(source, "accessor", expected, found)
        if count is None or count * stride > size:
            expected = f"elements within the {size} numbers of its array"
            raise InputError(source, "accessor", expected, f"{accessor.get('count')} of {width}")


def _check_nodes(source: str, root: Any) -> None:
    """Count the nodes of all scenes as their instances multiply them."""
    named = {node.get("id"): node for node in _each(root, "node") if node.get("id")}
    counts: dict[Any, int] = {}
    waiting = [(node, False) for scene in _each(root, "visual_scene") for node in _nodes(scene)]
    open_nodes: set[Any] = set()
    while waiting:
        node, is_left = waiting.pop()
        inner = [*_nodes(node), *_instanced(node, named)]
        if is_left:
            open_nodes.discard(node)
            counts[node] = 1 + sum(counts.get(each, 0) for each in inner)
            if counts[node] > MAX_NODES:
                found = "more, counted with all instances"
                raise InputError(source, "nodes", f"at most {MAX_NODES:,}", found)
        elif node in open_nodes:
            raise InputError(source, "nodes", "none in a circle", f"{node.get('id')!r} in one")
        elif node not in counts:
            open_nodes.add(node)
            waiting.append((node, True))
            waiting += [(each, False) for each in inner if each not in counts]


def _instanced(node: Any, named: dict[str, Any]) -> Iterator[Any]:
    for child in node:
        if _tag(child) == "instance_node":
            target = named.get((child.get("url") or "").removeprefix("#"))
            if target is not None:
                yield target


def _nodes(element: Any) -> list[Any]:
    return [child for child in element if _tag(child) == "node"]


def _each(root: Any, name: str) -> Iterator[Any]:
    return (element for element in root.iter() if _tag(element) == name)


def _tag(element: Any) -> str:
    """An element's name without its namespace; empty for a comment."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None

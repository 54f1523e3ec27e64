"""STL, binary and ASCII."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pe_core.base.errors import InputError, require_memory
from pe_core.base.files import decode_text
from pe_core.scene.mesh import Mesh

from .mesh import TEXT_UNFOLDS, make_mesh, require_room

_HEADER = 84  # 80 bytes of anything, then the number of triangles
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: Path, data: bytes) -> Mesh:
    """Read an STL file; coordinates are metres in the ground frame.

    In ASCII, parts have the solids' names, or the file's stem for a solid without a name. A
    binary file is one part with the stem as its name. Stored normals are ignored.
    """
    source, count = str(path), int.from_bytes(data[80:_HEADER], "little")
    length = _HEADER + _FACET.itemsize * count
    # Many binary files begin with "solid", too, so the length is tested first.
    is_text = data[:512].lstrip()[:5].lower() == b"solid" and b"\0" not in data
    if len(data) != length and is_text:
        require_memory(path, "file", len(data) * TEXT_UNFOLDS)
        scan = _SolidLines(source, path.stem)
        lines = decode_text(data).split("\n")
        for number, line in enumerate(lines, 1):
            scan.take(number, line)
        scan.require(not scan.inside, len(lines), "endsolid", "the end of the file")
        require_room(source, len(scan.parts))
        return make_mesh(source, np.reshape(scan.points, (-1, 3, 3)), scan.parts, scan.names)
    if len(data) < _HEADER:
        found = f"{len(data)} bytes"
        raise InputError(source, "header", "'solid' or 84 bytes of binary STL header", found)
    if len(data) != length:
        expected = f"{length} bytes for the {count} triangles declared"
        raise InputError(source, "length", expected, f"{len(data)} bytes")
    require_room(source, count)
    facets = np.frombuffer(data, dtype=_FACET, offset=_HEADER)
    return make_mesh(source, facets["corners"], np.zeros(count, np.int32), [path.stem])


@dataclass(slots=True)
class _SolidLines:
    """Content of the lines of an ASCII file that were read."""

    source: str
    stem: str
    names: list[str] = field(default_factory=list)
    parts: list[int] = field(default_factory=list)
    points: list[float] = field(default_factory=list)
    inside: bool = False  # between solid and endsolid

    def take(self, number: int, line: str) -> None:
        words = line.split()
        kind = words[0].lower() if words else ""
        if kind == "vertex":
            self.require(self.inside, number, "vertices inside a solid", "one outside")
            self.points += self.vertex(number, words)
        elif kind in ("endfacet", "endsolid"):
            if kind == "endfacet":
                self.parts.append(len(self.names) - 1)
            self.inside = self.inside and kind == "endfacet"
            spare = len(self.points) // 3 - 3 * len(self.parts)
            self.require(spare == 0, number, "three vertices in each facet", f"{3 + spare}")
        elif kind == "solid":
            self.require(not self.inside, number, "endsolid before the next solid", "none")
            self.names.append(line.strip()[5:].strip() or self.stem)
            self.inside = True
        elif kind not in ("", "facet", "outer", "endloop"):
            self.require(False, number, "an STL keyword", repr(words[0][:40]))

    def vertex(self, number: int, words: list[str]) -> tuple[float, float, float]:
        try:
            x, y, z = map(float, words[1:])
        except ValueError as error:
            expected, found = "vertex and three numbers", repr(" ".join(words)[:60])
            raise InputError(self.source, f"line {number}", expected, found) from error
        return x, y, z

    def require(self, holds: bool, number: int, expected: str, found: str) -> None:
        if not holds:
            raise InputError(self.source, f"line {number}", expected, found)

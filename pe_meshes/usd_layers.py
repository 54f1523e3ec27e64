"""The files that a USD stage is composed of, checked before USD composes them.

USD opens whatever a layer refers to and composes all of it at once: a pipe would be waited for, and
references that refer to each other ten times over become billions of prims. So the layers are read
one by one first, and their prims counted as composition would multiply them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Ar, Sdf, Tf

from pe_core.errors import InputError
from pe_core.formats import MESH_BYTES

MAX_LAYERS = 1_000
MAX_PRIMS = 200_000
"""Of a stage, instances counted each time."""
MAX_DEPTH = 1_000
"""Brackets of a text layer inside each other."""
TEXT_MAGIC = b"#usda"
CHUNK_BYTES = 1 << 24
STEPS = np.zeros(256, np.int8)
for _open, _close in ("()", "[]", "{}"):
    STEPS[ord(_open)], STEPS[ord(_close)] = 1, -1


def check_layers(path: Path) -> None:
    """Check a stage's root layer and all that it refers to.

    Raises
    ------
    InputError
        A file that is missing, no regular file, no USD or too deeply nested; references in a
        circle; more layers or prims than the limits.
    """
    _Layers(str(path)).prims_below(str(path), Sdf.Path.absoluteRootPath, ())


class _Layers:
    """Layers that were opened, and how many prims each of their prims comes to."""

    def __init__(self, source: str) -> None:
        self._source = source
        self._layers: dict[str, Any] = {}
        self._counts: dict[tuple[str, Any], int] = {}

    def prims_below(self, name: str, path: Any, above: tuple[tuple[str, Any], ...]) -> int:
        """How many prims a prim of a layer comes to, with all that is referred to."""
        key = (name, path)
        if key in above:
            raise InputError(self._source, "references", "none in a circle", f"{name} in one")
        if key not in self._counts:
            if len(above) > MAX_DEPTH:
                raise InputError(self._source, "references", f"at most {MAX_DEPTH} deep", "more")
            self._counts[key] = self._count(name, path, (*above, key))
        return self._counts[key]

    def _count(self, name: str, path: Any, above: tuple[tuple[str, Any], ...]) -> int:
        layer = self._layer(name)
        if path == Sdf.Path.absoluteRootPath:
            specs = list(layer.rootPrims)
            total = sum(
                self.prims_below(self._resolved(layer, each), path, above)
                for each in layer.subLayerPaths
            )
        else:
            spec = layer.GetPrimAtPath(path)
            specs, total = ([] if spec is None else [spec]), 0
        while specs:
            spec = specs.pop()
            total += 1
            for to, inner in self._referred(name, layer, spec):
                total += self.prims_below(to, inner, above)
            specs += list(spec.nameChildren)
            for variants in spec.variantSets.values():
                specs += [variant.primSpec for variant in variants.variants.values()]
            if total > MAX_PRIMS:
                found = "more, counted with all references"
                raise InputError(self._source, "prims", f"at most {MAX_PRIMS:,}", found)
        return total

    def _referred(self, name: str, layer: Any, spec: Any) -> Iterator[tuple[str, Any]]:
        """The layer and prim of every reference and payload of a prim."""
        for listed in (spec.referenceList, spec.payloadList):
            for each in listed.GetAddedOrExplicitItems():
                to = self._resolved(layer, each.assetPath) if each.assetPath else name
                inner = each.primPath
                if inner.isEmpty:
                    default = self._layer(to).defaultPrim
                    inner = Sdf.Path(f"/{default}") if default else Sdf.Path.absoluteRootPath
                yield to, inner

    def _resolved(self, layer: Any, asset: str) -> str:
        """The path of an asset that a layer names."""
        return str(layer.ComputeAbsolutePath(asset))

    def _layer(self, name: str) -> Any:
        if name not in self._layers:
            if len(self._layers) >= MAX_LAYERS:
                raise InputError(self._source, "layers", f"at most {MAX_LAYERS:,}", "more")
            self._layers[name] = self._opened(name)
        return self._layers[name]

    def _opened(self, name: str) -> Any:
        package = Ar.SplitPackageRelativePathOuter(name)[0] if "[" in name else name
        _check_file(self._source, Path(package))
        try:
            layer = Sdf.Layer.FindOrOpen(name)
        except Tf.ErrorException as error:
            raise InputError(name, "file", "USD", _first_line(error)) from error
        if layer is None:
            raise InputError(name, "file", "USD", "another file")
        return layer


def _check_file(source: str, path: Path) -> None:
    """Raise `InputError` unless a layer's file is there, regular and not too deeply nested."""
    if not path.exists():
        raise InputError(source, "references", "files that are there", f"none at {path}")
    if not path.is_file():
        raise InputError(path, "file", "a regular file", "something else")
    if path.stat().st_size > MESH_BYTES:
        raise InputError(path, "size", f"at most {MESH_BYTES:,} bytes", f"{path.stat().st_size:,}")
    with path.open("rb") as file:
        if file.read(len(TEXT_MAGIC)) != TEXT_MAGIC:
            return
        depth = 0
        while chunk := file.read(CHUNK_BYTES):
            depths = depth + np.cumsum(STEPS[np.frombuffer(chunk, np.uint8)], dtype=np.int64)
            if int(depths.max()) > MAX_DEPTH:
                raise InputError(path, "brackets", f"at most {MAX_DEPTH:,} deep", "more")
            depth = int(depths[-1])


def _first_line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return lines[0] if lines else type(error).__name__

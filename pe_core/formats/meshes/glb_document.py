"""A glTF document: its JSON items by index, and accessors as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError

Item = dict[str, Any]

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3}


@dataclass(frozen=True, slots=True)
class Document:
    """The JSON root and the binary chunk of one file."""

    source: str
    root: Item
    binary: memoryview

    def error(self, field: str, expected: str, found: str) -> InputError:
        """An error about this file."""
        return InputError(self.source, field, expected, found)

    def item(self, kind: str, index: Any) -> Item:
        """Item `index` of the array `kind`; `InputError` if there is none."""
        items = self.root.get(kind, [])
        if type(index) is not int or not 0 <= index < len(items):
            raise self.error(kind, f"an index below {len(items)}", repr(index))
        item = items[index]
        if not isinstance(item, dict):
            raise self.error(f"{kind}[{index}]", "an object", type(item).__name__)
        return item

    def accessor(self, index: Any, kind: str) -> NDArray[Any]:
        """The accessor's values, (N, 1) for SCALAR or (N, 3) for VEC3; not copied.

        Raises
        ------
        InputError
            Sparse, without data, of another type, or reaching past its buffer view.
        """
        accessor = self.item("accessors", index)
        field = f"accessors[{index}]"
        if "sparse" in accessor or "bufferView" not in accessor:
            found = "a sparse one" if "sparse" in accessor else "no bufferView"
            raise self.error(field, "a plain accessor with a bufferView", found)
        if accessor.get("type") != kind or accessor.get("componentType") not in _COMPONENTS:
            found = f"{accessor.get('type')} of {accessor.get('componentType')}"
            raise self.error(field, f"{kind} of a known componentType", found)
        code = np.dtype(_COMPONENTS[accessor["componentType"]])
        return self._elements(field, accessor, code, _WIDTHS[kind])

    def numbers(self, index: Any, values: NDArray[Any]) -> NDArray[np.float64]:
        """Values out of an accessor as what they stand for: fractions, if it is normalized."""
        if self.item("accessors", index).get("normalized") and values.dtype.kind in "iu":
            return np.maximum(values / np.iinfo(values.dtype).max, -1.0)
        return values.astype(np.float64)

    def count(self, index: Any) -> int:
        """How many elements an accessor says it has."""
        return self._whole(f"accessors[{index}]", self.item("accessors", index), "count")

    def _elements(
        self, field: str, accessor: Item, code: np.dtype[Any], width: int
    ) -> NDArray[Any]:
        view_index = accessor["bufferView"]
        view = self.item("bufferViews", view_index)
        data = self._view(f"bufferViews[{view_index}]", view)
        size = code.itemsize * width
        offset = self._whole(field, accessor, "byteOffset", 0)
        count = self._whole(field, accessor, "count")
        stride = self._whole(field, view, "byteStride", size)
        end = offset + stride * (count - 1) + size
        if stride < size or count < 1 or end > len(data):
            expected = f"elements of {size} bytes within the {len(data)} of the bufferView"
            found = f"{count} from {offset}, {stride} apart"
            raise self.error(field, expected, found)
        return np.ndarray((count, width), code, data, offset, (stride, code.itemsize))

    def _view(self, field: str, view: Item) -> memoryview:
        if self._whole(field, view, "buffer") != 0 or "uri" in self.item("buffers", 0):
            raise self.error(field, "data in the file's own binary chunk", "another buffer")
        start = self._whole(field, view, "byteOffset", 0)
        length = self._whole(field, view, "byteLength")
        if start + length > len(self.binary):
            expected = f"bytes within the {len(self.binary)} of the binary chunk"
            raise self.error(field, expected, f"{length} from {start}")
        return self.binary[start : start + length]

    def _whole(self, field: str, item: Item, key: str, default: int | None = None) -> int:
        value = item.get(key, default)
        if type(value) is not int or value < 0:
            raise self.error(f"{field}.{key}", "a whole number from 0 up", repr(value))
        return value

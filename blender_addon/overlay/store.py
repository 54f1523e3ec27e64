"""What is shown: shapes by scene, layer and sensor. Plain data, no Blender, no GPU."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass

from ..engine import graphics


@dataclass(frozen=True, slots=True, eq=False)
class ShownLayer:
    """A shape, and what it was made from; `rough` while something moves."""

    key: Hashable
    shape: graphics.LayerShape
    rough: bool


class Store:
    """Shapes that are ready to be drawn."""

    def __init__(self) -> None:
        self._items: dict[tuple[str, str], dict[str, ShownLayer]] = {}

    def items(self, scene: str, layer: str) -> Mapping[str, ShownLayer]:
        """Return what a layer shows in a scene, by the sensor's name."""
        return self._items.get((scene, layer), {})

    def put(self, scene: str, layer: str, items: Mapping[str, ShownLayer]) -> None:
        """Show these in a layer, and nothing else."""
        self._items[scene, layer] = dict(items)

    def drop(self, scene: str, layer: str) -> None:
        """Show nothing in a layer."""
        self._items.pop((scene, layer), None)

    def clear(self) -> None:
        """Show nothing at all."""
        self._items = {}

    def layers(self, scene: str) -> Iterator[tuple[str, Mapping[str, ShownLayer]]]:
        """Yield layers and what they show in a scene."""
        yield from ((layer, items) for (of, layer), items in self._items.items() if of == scene)

    def __len__(self) -> int:
        return sum(map(len, self._items.values()))


shown = Store()
"""The one that is drawn from."""

"""What a script of pictures has in hand: the window, and where pictures go."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tests.blender.stage import Stage

from .files import Box, Frame, save_film, save_still

WHOLE = (0, 32, 1600, 874)
"""The window without Blender's own first and last line."""
DRAW = "bpy.ops.wm.redraw_timer(type='DRAW_WIN_SWAP', iterations=1)"
"""Has Blender draw at once, however busy the machine is."""


@dataclass
class Camera:
    """A window and the folder of its pictures; `kept` has their sizes in bytes."""

    stage: Stage
    out: Path
    scratch: Path
    kept: dict[str, int] = field(default_factory=dict)
    frames: list[Frame] = field(default_factory=list)
    caption: str = ""

    def still(self, name: str, crop: Box = WHOLE) -> None:
        """Keep what the window shows as docs/images/NAME.png."""
        raw = self.scratch / "raw.png"
        self.stage.do(DRAW)
        self.stage.photograph(raw)
        self.kept[name] = save_still(raw, self.out / f"{name}.png", crop)

    def keep(self, name: str, source: Path) -> None:
        """Keep a picture that the add-on has written."""
        path = shutil.copy(source, self.out / f"{name}{source.suffix}")
        self.kept[name] = path.stat().st_size

    def frame(self, shown_ms: int) -> None:
        """Take another picture for the film, with the present caption."""
        path = self.scratch / f"frame_{len(self.frames):04d}.png"
        self.stage.do(DRAW)
        self.stage.photograph(path)
        self.frames.append(Frame(path, shown_ms, self.caption))

    def film(self, name: str, crop: Box, width: int) -> None:
        """Put the film together as docs/images/NAME.webp."""
        path = self.out / f"{name}.webp"
        self.kept[name] = save_film(self.frames, path, crop, width)
        self.frames.clear()


Shot = Callable[[Camera], None]


@dataclass(frozen=True)
class Reel:
    """Pictures that are made one after the other in one window.

    `blend` is a file that `prepare` has made, or one of blend_assets.
    """

    blend: str
    shots: Sequence[Shot]

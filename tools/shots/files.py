"""Pictures made small: PNG for stills, an animated WebP for the film."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from PIL import Image, ImageDraw, ImageFont

Box = tuple[int, int, int, int]
MAX_PIXELS = 1600
"""Along the longer side."""
LOST_BITS = (0, 1, 2, 3)
MAX_PNG_BYTES = 400_000
MAX_FILM_BYTES = 3_000_000
CAPTION_PX = 44


def save_still(source: Path, target: Path, crop: Box | None = None) -> int:
    """Write a screenshot as a PNG, as true as its size allows; return its size in bytes.

    Of a large one the last bits of each colour are rounded away. A palette would be smaller, but it
    drops colours that are rare, and those of a legend are.
    """
    image = Image.open(source).convert("RGB")
    if crop:
        image = image.crop(crop)
    image.thumbnail((MAX_PIXELS, MAX_PIXELS), Image.Resampling.LANCZOS)
    for lost in LOST_BITS:
        rounded(image, lost).save(target, optimize=True)
        if target.stat().st_size <= MAX_PNG_BYTES:
            break
    return checked(target, MAX_PNG_BYTES)


def rounded(image: Image.Image, bits: int) -> Image.Image:
    """Return a picture whose colours are rounded to multiples of a power of two."""
    step = 1 << bits
    return image.point([min(round(level / step) * step, 255) for level in range(256)] * 3)


class Frame(NamedTuple):
    """A screenshot of a film, how long it is shown, and the words below it."""

    path: Path
    shown_ms: int
    caption: str = ""


def save_film(
    frames: Sequence[Frame], target: Path, crop: Box, width: int, quality: int = 60
) -> int:
    """Write screenshots as an animation that runs for ever; return its size in bytes."""
    height = round(width * (crop[3] - crop[1]) / (crop[2] - crop[0]))
    images = []
    for frame in frames:
        image = Image.open(frame.path).convert("RGB").crop(crop)
        image = image.resize((width, height), Image.Resampling.LANCZOS)
        images.append(captioned(image, frame.caption) if frame.caption else image)
    images[0].save(
        target,
        save_all=True,
        append_images=images[1:],
        duration=[frame.shown_ms for frame in frames],
        loop=0,
        quality=quality,
        method=4,
    )
    return checked(target, MAX_FILM_BYTES)


def captioned(image: Image.Image, words: str) -> Image.Image:
    """Return a picture with a line of words in a bar below it."""
    width, height = image.size
    whole = Image.new("RGB", (width, height + CAPTION_PX), "#14171a")
    whole.paste(image)
    pen = ImageDraw.Draw(whole)
    font = ImageFont.load_default(size=20)
    pen.text((width / 2, height + CAPTION_PX / 2), words, "#f2f4f5", font, anchor="mm")
    return whole


def checked(path: Path, most: int) -> int:
    """Return the size of a file; complain about one that is too large for a repository."""
    size = path.stat().st_size
    if size > most:
        raise AssertionError(f"{path.name} has {size:,} bytes; {most:,} at most")
    return size

#!/usr/bin/env python3
"""Draw the letters of pictures as one strip of pixels, which pictures then need no font for.

usage: tools/letters.py       needs matplotlib, which has the font (DejaVu Sans, free) and Pillow
"""

from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "pe_tools" / "page" / "pictures" / "letters.npz"
FONT = Path(matplotlib.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")
SIZE_PX, BASELINE_PX, HEIGHT_PX = 24, 25, 32
UNKNOWN = 0x25A1
"""The box that stands for a letter that is not among these."""
RANGES = ((0x20, 0x7F), (0xA0, 0x180), (0x386, 0x3CF), (0x400, 0x460))
"""Latin, Greek and Cyrillic letters."""
OTHERS = (0x2013, 0x2014, 0x2026, 0x2192, 0x2212, UNKNOWN)


def main() -> None:
    """Write the strip, where each letter begins in it, and the letters' codes."""
    codes = sorted({*(code for low, high in RANGES for code in range(low, high)), *OTHERS})
    font = ImageFont.truetype(str(FONT), SIZE_PX)
    widths = [max(round(font.getlength(chr(code))), 1) for code in codes]
    starts = np.concatenate([[0], np.cumsum(widths)])
    strip = np.zeros((HEIGHT_PX, starts[-1]), np.uint8)
    for code, start, end in zip(codes, starts[:-1], starts[1:], strict=True):
        tile = Image.new("L", (end - start, HEIGHT_PX))
        ImageDraw.Draw(tile).text((0, BASELINE_PX), chr(code), fill=255, font=font, anchor="ls")
        strip[:, start:end] = np.asarray(tile)
    codes, starts = np.array(codes, np.int32), starts.astype(np.int32)
    np.savez_compressed(OUTPUT, codes=codes, starts=starts, strip=strip)
    print(f"{OUTPUT.relative_to(ROOT)}: {len(codes)} letters, {OUTPUT.stat().st_size} bytes")


if __name__ == "__main__":
    main()

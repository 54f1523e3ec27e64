"""Plots with matplotlib: their style, which is that of all studies.

The palette is that of Okabe and Ito, safe for colour-blind readers.
"""

from __future__ import annotations

import functools
import io
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pe_core.base import write_bytes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLUE = "#0072B2"
ORANGE = "#E69F00"
GREEN = "#009E73"
VERMILION = "#D55E00"
SKY = "#56B4E9"
PURPLE = "#CC79A7"
GREY = "#8A8A8A"
PALETTE = (BLUE, ORANGE, GREEN, VERMILION, PURPLE)

STYLE = {
    "font.size": 9.5,
    "axes.titlesize": 9.5,
    "axes.labelcolor": "#333333",
    "axes.edgecolor": "#999999",
    "xtick.color": "#333333",
    "ytick.color": "#333333",
    "savefig.dpi": 110,
}
MAX_NAME = 48
"""Characters of a name that a plot has space for."""


def pyplot() -> Any:
    """Return ``matplotlib.pyplot``, which draws without a window. The first call imports it."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot

    return matplotlib.pyplot


def styled(draw: Callable[..., None]) -> Callable[..., None]:
    """Decorate a function that draws: it draws in `STYLE`, whatever the user's settings are."""

    @functools.wraps(draw)
    def draw_styled(*arguments: Any) -> None:
        plt = pyplot()
        with plt.rc_context({**plt.rcParamsDefault, "backend": "Agg", **STYLE}):
            draw(*arguments)

    return draw_styled


def remove_frame(axes: Axes) -> None:
    """Remove the upper and the right line of the frame."""
    axes.spines[["top", "right"]].set_visible(False)


def save_plot(figure: Figure, path: Path) -> None:
    """Write a plot without matplotlib's version in it: the same plot gives the same file.
    `InputError` where it cannot be written."""
    picture = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)  # a box is shown
        figure.savefig(picture, metadata={"Software": None})
    pyplot().close(figure)
    write_bytes(path, picture.getvalue())


def shortened(name: str, max_length: int = MAX_NAME) -> str:
    """Return a name from a file as one printable line, cut where it is longer than that."""
    line = "".join(c if c.isprintable() else "?" for c in name)
    return line if len(line) <= max_length else f"{line[: max_length - 3]}..."

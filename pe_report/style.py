"""Colours and looks of the plots: the palette of Okabe and Ito, safe for colour-blind readers."""

from __future__ import annotations

import functools
import io
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pe_core.text import write_bytes

BLUE, ORANGE, GREEN, VERMILION = "#0072B2", "#E69F00", "#009E73", "#D55E00"
SKY, PURPLE, GREY = "#56B4E9", "#CC79A7", "#8A8A8A"
PALETTE = (BLUE, ORANGE, GREEN, VERMILION, PURPLE)

LOOK = {
    "font.size": 9.5,
    "axes.titlesize": 9.5,
    "axes.labelcolor": "#333333",
    "axes.edgecolor": "#999999",
    "xtick.color": "#333333",
    "ytick.color": "#333333",
    "savefig.dpi": 110,
}


def style(draw: Callable[..., None]) -> Callable[..., None]:
    """Draw in the house's looks, whatever the user's own settings are."""

    @functools.wraps(draw)
    def styled(*arguments: Any) -> None:
        with plt.rc_context({**plt.rcParamsDefault, "backend": "Agg", **LOOK}):
            draw(*arguments)

    return styled


def finished(axes: Axes) -> None:
    """Take off the frame's upper and right side."""
    axes.spines[["top", "right"]].set_visible(False)


def save(figure: Figure, path: Path) -> None:
    """Write a figure, without the software's version in it: the same plot is the same file.

    Raises
    ------
    InputError
        When it cannot be written there.
    """
    picture = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)  # a box is shown
        figure.savefig(picture, metadata={"Software": None})
    plt.close(figure)
    write_bytes(path, picture.getvalue())

"""Plots with matplotlib: their style, and the plot of a Pareto front for the verb ``pe front``.

The palette is that of Okabe and Ito, safe for colour-blind readers. matplotlib is an optional
dependency: it is imported when the first plot is drawn, and `check_matplotlib` says when it is
missing.
"""

from __future__ import annotations

import argparse
import functools
import io
import warnings
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pe_core import InputError
from pe_core.base import parse_json, read_bytes, write_bytes

from ..cli import DONE, Answer
from ..jobs import FRONT_JSON, FRONT_PLOT, FileSet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

EXTRA = 'pip install "perception-entropy[report]"'
"""The command that installs matplotlib."""

BLUE, ORANGE, GREEN, VERMILION = "#0072B2", "#E69F00", "#009E73", "#D55E00"
SKY, PURPLE, GREY = "#56B4E9", "#CC79A7", "#8A8A8A"
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

FRONT_KEYS = ("name", "on_front", "price", "entropy")
"""What the plot of a Pareto front needs of each design."""
FRONT_SIZE_IN, KEY_LINE_IN, KEY_MARGIN_IN = (10.4, 4.4), 0.21, 0.9
"""Smallest size of the picture; height of a line of the key, and of the margin around the key."""
MAX_KEY_NAME = 80
"""Characters of a name in the key."""
FRONT_MARGIN = 0.08
"""Free space around the designs, as a share of the range of their values."""


def has_matplotlib() -> bool:
    """Whether matplotlib is installed; it is not imported."""
    try:
        return find_spec("matplotlib") is not None
    except ValueError:  # sys.modules holds a module without a specification
        return False


def check_matplotlib() -> None:
    """Raise `InputError` where matplotlib is missing."""
    if not has_matplotlib():
        raise InputError("plots", "package", f"matplotlib: {EXTRA}", "no matplotlib")


def pyplot() -> Any:
    """Return ``matplotlib.pyplot``, which draws without a window; `InputError` where it is missing.
    The first call imports it."""
    check_matplotlib()
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


def front(args: argparse.Namespace) -> Answer:
    """Run the verb ``front``: draw the Pareto front of a folder again."""
    folder = Path(args.folder)
    write_front_plot(read_front(folder / FRONT_JSON), folder)
    return str(folder / FRONT_PLOT), DONE


def write_front_plot(data: Mapping[str, Any], folder: Path) -> None:
    """Write the plot of a Pareto front to its folder. `InputError` where matplotlib is missing, or
    a file of that name is not ours."""
    check_matplotlib()
    with FileSet(folder) as files:
        files.add(FRONT_PLOT, lambda path: draw_front(path, data))


def read_front(path: Path) -> dict[str, Any]:
    """Return currency and designs of a front.json; `InputError` for any other file."""
    try:
        data = parse_json(path, read_bytes(path))
        rows = [{key: row[key] for key in FRONT_KEYS} for row in data["designs"]]
        if not any(row["on_front"] for row in rows):
            raise ValueError
        for row in rows:
            row |= {"price": float(row["price"]), "entropy": float(row["entropy"])}
            row["name"] = str(row["name"])
        return {"currency": str(data["currency"]), "designs": rows}
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(path, "file", "the front that `pe optimize` wrote", "another") from None


@styled
def draw_front(path: Path, data: Mapping[str, Any]) -> None:
    """Draw price against entropy from the data of a front.json: designs numbered, named beside."""
    front = [row for row in data["designs"] if row["on_front"]]
    dominated = [row for row in data["designs"] if not row["on_front"]]
    height = max(FRONT_SIZE_IN[1], KEY_MARGIN_IN + KEY_LINE_IN * len(front))
    figure, (left, right) = pyplot().subplots(
        1, 2, figsize=(FRONT_SIZE_IN[0], height), width_ratios=(1.15, 1), layout="constrained"
    )
    _draw_designs(left, front, dominated)
    unit = f" [{shortened(data['currency'])}]" if data["currency"] else ""
    left.set(xlabel=f"price{unit}", ylabel="perception entropy [nats], lower is better")
    _draw_key(right, front)
    save_plot(figure, path)


def _draw_designs(
    axes: Axes, front: Sequence[Mapping[str, Any]], dominated: Sequence[Mapping[str, Any]]
) -> None:
    prices, entropies = ([row[key] for row in front] for key in ("price", "entropy"))
    axes.step(prices, entropies, where="post", color=BLUE, lw=1.2, alpha=0.5, zorder=1)
    if dominated:
        x, y = ([row[key] for row in dominated] for key in ("price", "entropy"))
        axes.scatter(x, y, s=18, facecolors="white", edgecolors=GREY, lw=0.8, zorder=2)
    axes.scatter(prices, entropies, s=110, color=BLUE, zorder=3)
    number_style: dict[str, Any] = {"color": "white", "size": 8.5, "zorder": 4}
    centered: dict[str, Any] = {"ha": "center", "va": "center_baseline"}
    for number, (price, entropy) in enumerate(zip(prices, entropies, strict=True), 1):
        axes.text(price, entropy, str(number), **number_style, **centered)
    axes.margins(FRONT_MARGIN)
    axes.grid(color="#eeeeee", lw=0.8)
    axes.set_axisbelow(True)
    remove_frame(axes)


def _draw_key(axes: Axes, front: Sequence[Mapping[str, Any]]) -> None:
    """Write number and name of each design of the front, in the order of the numbers."""
    axes.axis("off")
    for number, row in enumerate(front, 1):
        name = shortened(row["name"], MAX_KEY_NAME)
        y = 1.0 - (number - 0.5) / max(len(front), 12)
        axes.text(0.04, y, str(number), color=BLUE, weight="bold", size=8, ha="right", va="center")
        axes.text(0.07, y, name, va="center", size=8)

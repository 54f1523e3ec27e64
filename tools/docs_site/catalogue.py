"""Pages of the catalogue: each sensor's figures, source, and drawing of its field of view."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pe_core import catalog
from pe_core.scene import Pose, Sensor
from pe_core.sensors import kind_of
from pe_tools import graphics
from pe_tools.page.pictures.svg import Canvas

FOLDER = "reference/catalogue"
WIDTH = 260.0
HEIGHT = 240.0
GAP = 20.0
BEAMS = 360
BEAMS_ABOVE = 120
INK = "#57606a"
SOFT = "#d8dee4"
TITLES = ("from the side", "from above")
Floats = NDArray[np.float64]
Shapes = list[tuple[int, Floats, tuple[float, ...]]]
"""Lines (2 corners) or triangles (3), (N, corners, 2) points in lengths of the view; a colour."""


def slug(name: str) -> str:
    """Return a name as part of an address."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def pages() -> dict[str, str]:
    """Return the pages, a maker each, and the pictures, by their paths in the site."""
    makers: dict[str, list[catalog.Entry]] = {}
    for entry in catalog.entries().values():
        makers.setdefault(entry.maker, []).append(entry)
    made = {f"{FOLDER}/index.md": index(makers)}
    for maker, entries in makers.items():
        made[f"{FOLDER}/{slug(maker)}.md"] = maker_page(maker, entries)
        for entry in entries:
            made[f"{FOLDER}/{slug(entry.name)}.svg"] = picture(entry.name)
    return made


def index(makers: dict[str, list[catalog.Entry]]) -> str:
    """Return the first page: a table of all sensors."""
    rows = []
    for maker, entries in makers.items():
        for entry in entries:
            model = catalog.load(entry.name)
            link = f"[{entry.name}]({slug(maker)}.md#{slug(entry.name)})"
            rows.append(f"| {link} | {entry.kind} | {kind_of(model).summary(model)} |\n")
    return (
        "# Catalogue of sensors\n\nAll presets with their figures. The name in the first column is"
        " the `model` of a study's [sensor](../../study.md). `pe sensors NAME` prints the same.\n\n"
        "| sensor | kind | figures |\n| --- | --- | --- |\n" + "".join(rows)
    )


def maker_page(maker: str, entries: list[catalog.Entry]) -> str:
    """Return the page of a maker: a section a sensor."""
    head = (
        f"# {maker}\n\nEach picture shows the field of view from the side and from above; the"
        " direction of view is to the right. The lines are those of the channels ahead, and"
        " of some azimuths.\n"
    )
    return head + "".join(section(entry) for entry in entries)


def section(entry: catalog.Entry) -> str:
    """Return the section of a sensor."""
    model = catalog.load(entry.name)
    lines = [re.split(r"\s{2,}", line, maxsplit=1) for line in kind_of(model).data_sheet(model)]
    rows = "".join(f"| {' | '.join((*cells, '')[:2])} |\n" for cells in lines)
    note = entry.table.get("note", "")
    body = catalog.housing(entry.name)
    size = "" if body is None else f"| housing | {body.shape}, {body_size(body)} |\n"
    return (
        f"\n## {entry.name} {{ #{slug(entry.name)} }}\n\n"
        f"![Field of view of {entry.name}]({slug(entry.name)}.svg){{ .field loading=lazy }}\n\n"
        f"| | |\n| --- | --- |\n{rows}{size}| source | {cell(entry.source)} |\n"
        + (f"| note | {cell(str(note))} |\n" if note else "")
    )


def body_size(body) -> str:
    """Return the size of a housing in millimetres."""
    return " x ".join(f"{1000 * side:.0f}" for side in body.size) + " mm"


def cell(text: str) -> str:
    """Return a text for the cell of a table."""
    return text.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")


def picture(name: str) -> str:
    """Return the drawing of a sensor's field of view, as SVG: from the side and from above."""
    sensor = Sensor(name, catalog.load(name), Pose((0.0, 0.0, 0.0)))
    drawing = _lidar_views if sensor.kind == "lidar" else _sketched_views
    canvas = Canvas(2 * WIDTH + GAP, HEIGHT, f"Field of view of {name}")
    for left, title, shapes in zip((0.0, WIDTH + GAP), TITLES, drawing(sensor), strict=True):
        _view(canvas, shapes, left)
        at = {"x": left + WIDTH / 2, "y": HEIGHT - 6, "text_anchor": "middle"}
        canvas.text(words=title, fill=INK, font_size=12, font_family="sans-serif", **at)
    return str(canvas.svg()).replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1)


def _lidar_views(sensor: Sensor) -> Iterator[Shapes]:
    """Yield the channels of a LiDAR ahead, from the side; and its azimuths, from above."""
    lidar = sensor.model
    free = graphics.PAPER.free
    by_channel = lidar.directions.reshape(len(lidar.elevations), -1, 3)
    ahead = by_channel[:, int(by_channel[..., 0].mean(axis=0).argmax())]
    fan = np.column_stack([np.hypot(ahead[:, 0], ahead[:, 1]), ahead[:, 2]])
    if by_channel.shape[1] == 1:  # every beam has its own elevation
        fan = _thinned(fan, BEAMS)
    yield [(2, np.stack([np.zeros_like(fan), fan], axis=1), free)]
    beams = by_channel.reshape(-1, 3)
    azimuths = _thinned(np.sort(np.arctan2(beams[:, 1], beams[:, 0])), BEAMS_ABOVE)
    rays = np.column_stack([np.cos(azimuths), np.sin(azimuths)])
    yield [(2, np.stack([np.zeros_like(rays), rays], axis=1), free)]


def _thinned(rows: Floats, count: int) -> Floats:
    """Return at most so many of some rows, evenly chosen, with the first and the last."""
    return rows[np.linspace(0, len(rows) - 1, min(count, len(rows))).round().astype(int)]


def _sketched_views(sensor: Sensor) -> Iterator[Shapes]:
    """Yield what the 3D view draws of a sensor: from the side and from above."""
    drawing = graphics.drawing_of(sensor.kind)
    for axes in ((0, 2), (0, 1)):
        shapes = []
        for corners, drawn in ((3, drawing.faces), (2, drawing.lines)):
            primitives = drawn(sensor, 1.0, graphics.PAPER)
            points = primitives.points.astype(float)[:, axes].reshape(-1, corners, 2)
            if len(points):
                shapes.append((corners, points, tuple(primitives.colors[0])))
        yield shapes


def _view(canvas: Canvas, shapes: Shapes, left: float) -> None:
    middle = np.array([left + WIDTH / 2, HEIGHT / 2 - 8])
    scale = 0.42 * WIDTH
    for radius in (0.5, 1.0):
        canvas.add("circle", cx=middle[0], cy=middle[1], r=radius * scale, fill="none", stroke=SOFT)
    for corners, points, color in shapes:
        flat = points * [scale, -scale] + middle
        thin = min(1.0, 0.6 + 20.0 / len(points))
        look = {"fill": graphics.color_text(color), "fill_opacity": "0.2"}
        if corners == 2:
            look = {
                "stroke": graphics.color_text(color),
                "fill": "none",
                "stroke_width": f"{thin:.2f}",
            }
        canvas.path(flat, closed=corners == 3, **look)
    canvas.add("circle", cx=middle[0], cy=middle[1], r=2.5, fill=INK)

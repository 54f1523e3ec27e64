"""One closed half of a vehicle: the skin's panels, the wheel housings and the floor."""

from __future__ import annotations

import numpy as np
import skin as skinning
from panel_lines import Line, Panel, classify
from parts import Part, chains, fill, join


def housings(skin: skinning.Skin, arch: Line, well_y: float) -> Part:
    """Inner walls of the wheel openings, and in place the openings themselves.

    `arch` is negative in the openings; the walls reach inwards to `well_y`.
    """
    skin.keep(arch(skin.centres()) > 0)
    edges = skinning.boundary(skin.triangles)
    off = np.abs(arch(skin.points[edges].reshape(-1, 3)).reshape(-1, 2))
    on_arch = off.max(axis=1) < 2e-3
    found = []
    for path in chains(edges[on_arch]):
        outer = skin.points[path]
        inner = outer * [1, 0, 1] + [0, well_y, 0]
        points = np.vstack([outer, inner])
        faces = skinning.split_quads(points, skinning.quads(2, len(outer)))
        cap = fill(inner, np.array([0.0, 1.0, 0.0])) + len(outer)
        triangles = np.vstack([faces, cap])
        found.append(Part(points, triangles, ["trim"] * len(triangles)))
    return join(*found)


def floor(body: Part) -> Part:
    """A panel over the open lower edge of the left half, to the centre plane."""
    points, triangles = skinning.weld(body.points, body.triangles)
    edges = skinning.boundary(triangles)
    edges = edges[np.abs(points[edges][:, :, 1]).max(axis=1) > 1e-6]
    path = max(chains(edges), key=len)
    loop = points[path]
    flat = fill(loop * [1, 1, 0], np.array([0.0, 0.0, -1.0]))
    return Part(loop, flat, ["trim"] * len(flat))


def half_shell(
    skin: skinning.Skin, panels: list[Panel], arch: Line, well_y: float
) -> dict[str, Part]:
    """The cut left half as named parts; `body` has the wheel housings and the floor too."""
    wells = housings(skin, arch, well_y)
    found = classify(panels, skin.centres())
    result = {}
    for name in dict.fromkeys(panel.name for panel in panels):
        mine = [i for i, panel in enumerate(panels) if panel.name == name]
        chosen = np.isin(found, mine)
        materials = [panels[i].material for i in found[chosen]]
        result[name] = Part(skin.points, skin.triangles[chosen], materials)
    shell = Part(skin.points, skin.triangles, ["paint"] * len(skin.triangles))
    result["body"] = join(result["body"], wells, floor(join(shell, wells)))
    return result

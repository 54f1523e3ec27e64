"""The forward and up axes of a mesh file: from the study, from the file, or guessed. The axes of
the study come first, then those that the file names. Without either, the names of parts and the
shape decide; the last resort is a default. A text says how the axes were determined."""

import re
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, shown
from pe_core.geometry.poses import Pose, rotate
from pe_core.scene.mesh import BodyShape, Mesh, MeshAxes
from pe_core.scene.vehicle_description import along, front_by_names, hood_end, up_of

BLENDER_S_FRONT = "-y"
"""Forward axis if z is up and the body is along y: Blender's front view shows the front so."""
COMMENT_BYTES = 4096  # Maximum position in a text file of the comments that name its axes
_COMMENT = re.compile(
    rb"^#.*?([+-]?)([xyz])[ -]*(forward|up)\b(?:.*?([+-]?)([xyz])[ -]*(up)\b)?",
    re.IGNORECASE | re.MULTILINE,
)
_TEXT = re.compile(r"faces ([+-][xyz]) \((.*?)\), up is ([+-][xyz]) \((.*?)\)")


class SaidAxes(NamedTuple):
    """Axes and their sources; an empty source marks a default, which a guess may replace."""

    up: str
    up_by: str
    forward: str
    forward_by: str


OURS = SaidAxes("+z", "file", "+x", "file")
GLTF = SaidAxes("+y", "format", "+z", "")
"""glTF also defines +Z forward, but many exporters do not rotate the body: its shape decides."""
UNSAID = SaidAxes("+z", "", "+x", "")


def said_in_comments(data: bytes) -> SaidAxes:
    """Return the axes that comments of a text file name ("x forward, z up")."""
    axis_by_word: dict[str, str] = {}
    for match in _COMMENT.finditer(data[:COMMENT_BYTES]):
        for sign, axis, word in (match.groups()[:3], match.groups()[3:]):
            if word:
                name = f"{(sign or b'+').decode()}{axis.decode().lower()}"
                axis_by_word.setdefault(word.decode().lower(), name)
    up = axis_by_word.get("up")
    forward = axis_by_word.get("forward")
    if up is None or forward is None or up[1] == forward[1]:
        return UNSAID
    return SaidAxes(up, "file", forward, "file")


def oriented(source: str, mesh: Mesh, said: SaidAxes, axes: MeshAxes) -> Mesh:
    """Return a mesh in the ground frame, with a text on how its axes were determined. The text is
    empty if the file is in the ground frame."""
    chosen = _chosen(mesh, said, axes)
    triangles = _turned(mesh.triangles, chosen.up, chosen.forward)
    if axes.scale != 1.0:
        triangles = triangles * axes.scale
        if not np.isfinite(triangles).all():
            raise InputError(source, "scale", "finite coordinates", shown(axes.scale))
    if any(axes.rotation_deg or ()):
        turn = Pose.from_degrees((0, 0, 0), axes.rotation_deg or ())
        triangles = rotate(turn.ground_from_sensor, triangles)
    up_by = chosen.up_by or "assumed"
    forward_by = chosen.forward_by or "assumed"
    text = f"faces {chosen.forward} ({forward_by}), up is {chosen.up} ({up_by})"
    return replace(mesh, triangles=triangles, axes="" if chosen == OURS else text)


def _chosen(mesh: Mesh, said: SaidAxes, axes: MeshAxes) -> SaidAxes:
    """Return the axes from the study, or else the file, or else a guess, or else the default."""
    said = _asked(said, axes)
    if axes.rotation_deg is not None or (said.up_by and said.forward_by):
        return _across(said)
    shape = BodyShape(mesh.triangles, mesh.parts, mesh.part_names)
    if not said.up_by and (guess := up_of(shape)) is not None:
        name = "+z" if guess[0] == 2 else "+y"
        if not (said.forward_by and said.forward[1] == name[1]):
            said = said._replace(up=name, up_by=guess[1])
    if said.forward_by:
        return _across(said)
    forward, by = _guessed_forward(shape, said)
    return _across(said._replace(forward=forward, forward_by=by))


def _asked(said: SaidAxes, axes: MeshAxes) -> SaidAxes:
    """Return the axes of the file, overridden by those of the study."""
    if axes.up is not None and (axes.up, "file") != (said.up, said.up_by):
        said = said._replace(up=axes.up, up_by="study")
    if axes.forward is not None and (axes.forward, "file") != (said.forward, said.forward_by):
        said = said._replace(forward=axes.forward, forward_by="study")
        if said.up[1] == axes.forward[1] and axes.up is None:
            said = said._replace(up="+y" if axes.forward[1] == "z" else "+z", up_by="")
    return said


def _guessed_forward(shape: BodyShape, said: SaidAxes) -> tuple[str, str]:
    up = "xyz".index(said.up[1])
    ahead = front_by_names(shape)
    if ahead is not None and ahead[0] != up:
        return f"{'+' if ahead[1] > 0 else '-'}{'xyz'[ahead[0]]}", "part names"
    axis = along(shape, up)
    if axis is None or "xyz"[axis] == said.forward[1]:
        return said.forward, said.forward_by
    if (end := hood_end(shape, axis, up)) is not None:
        return f"{'+' if end > 0.0 else '-'}{'xyz'[axis]}", "shape"
    lies_along_y = axis == 1 and said.up[1] == "z"
    return (BLENDER_S_FRONT if lies_along_y else f"+{'xyz'[axis]}"), "shape"


def _across(said: SaidAxes) -> SaidAxes:
    """Return axes with forward perpendicular to up; a default forward axis is replaced."""
    if said.up[1] != said.forward[1]:
        return said
    return said._replace(forward="+x" if said.up[1] != "x" else "+z", forward_by="")


def _turned(triangles: Floats, up: str, forward: str) -> Floats:
    """Triangles with forward, left, up as x, y, z; coordinates are only swapped and negated."""
    if (up, forward) == ("+z", "+x"):
        return triangles
    ahead = _unit(forward)
    above = _unit(up)
    turned = np.empty_like(triangles)
    for k, axis in enumerate((ahead, np.cross(above, ahead), above)):
        source = int(np.argmax(np.abs(axis)))
        if axis[source] > 0:
            turned[..., k] = triangles[..., source]
        else:
            np.negative(triangles[..., source], out=turned[..., k])
    return turned


def _unit(name: str) -> NDArray[np.int64]:
    axis = np.zeros(3, np.int64)
    axis["xyz".index(name[1])] = 1 if name[0] == "+" else -1
    return axis


def axes_in_text(text: str) -> SaidAxes:
    """Return the axes that `Mesh.axes` names, with their sources; empty: the ground frame."""
    match = _TEXT.fullmatch(text)
    if match is None:
        return OURS
    forward, forward_by, up, up_by = match.groups()
    return SaidAxes(up, up_by, forward, forward_by)

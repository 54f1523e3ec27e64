"""Which axes of a mesh file are forward and up: what is asked for, what the file says, a guess.

What a study says holds; then what the file says of itself; where neither does, names of parts and
the shape decide, and else a default. However it was, it can be told in words.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, shown
from ...scene.body_shape import BodyShape
from ...scene.facing import along, front_by_names, up_of
from ...scene.geometry import ROTATION_DEG, Pose, rotate
from ...scene.hood import hood_end
from ...text.values import Number, choice, vector
from .mesh import Mesh

Floats = NDArray[np.float64]

AXIS_NAMES = ("+x", "-x", "+y", "-y", "+z", "-z")
SCALE = Number(0.0, above=True, cap=1e6)
BLENDER_S_FRONT = "-y"
"""Where z is up and a body lies along y: what Blender shows from the front looks this way."""
COMMENT_BYTES = 4096
"""How far comments that say the axes of a text file are looked for."""
_COMMENT = re.compile(
    rb"^#.*?([+-]?)([xyz])[ -]*(forward|up)\b(?:.*?([+-]?)([xyz])[ -]*(up)\b)?",
    re.IGNORECASE | re.MULTILINE,
)


@dataclass(frozen=True, slots=True)
class MeshAxes:
    """How a study says a mesh is to be taken; what it leaves out is as the file says, or guessed.

    Parameters
    ----------
    up, forward : str, optional
        Axes of the file, of `AXIS_NAMES`.
    scale : float
        What lengths are multiplied by, after the file's own unit.
    rotation_deg : (3,) float, optional
        Roll, pitch, yaw by which the body is turned in the end; with it nothing is guessed.

    Raises
    ------
    InputError
        When an axis is none, both are along one line, the scale is not above 0, or the rotation
        is not three angles.
    """

    up: str | None = None
    forward: str | None = None
    scale: float = 1.0
    rotation_deg: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("up", "forward"):
            if (value := getattr(self, name)) is not None:
                choice("vehicle", name, value, AXIS_NAMES)
        if self.up and self.forward and self.up[1] == self.forward[1]:
            expected = f"an axis across up = {self.up}"
            raise InputError("vehicle", "forward", expected, self.forward)
        object.__setattr__(self, "scale", SCALE.checked("vehicle", "scale", self.scale))
        if self.rotation_deg is not None:
            turned = vector("vehicle", "rotation", self.rotation_deg, 3, ROTATION_DEG)
            object.__setattr__(self, "rotation_deg", turned)


AS_SAID = MeshAxes(rotation_deg=(0.0, 0.0, 0.0))
"""As the file says, or the default: nothing is guessed."""


class SaidAxes(NamedTuple):
    """What a file says, and by what; without a word for that it is a default, open to a guess."""

    up: str
    up_by: str
    forward: str
    forward_by: str


OURS = SaidAxes("+z", "file", "+x", "file")
GLTF = SaidAxes("+y", "format", "+z", "")
"""glTF says +Z forward, too, but many exporters leave a body as it was: its shape counts more."""
UNSAID = SaidAxes("+z", "", "+x", "")


def said_in_comments(data: bytes) -> SaidAxes:
    """Return the axes that comments of a text file name ("x forward, z up")."""
    found: dict[str, str] = {}
    for match in _COMMENT.finditer(data[:COMMENT_BYTES]):
        for sign, axis, word in (match.groups()[:3], match.groups()[3:]):
            if word:
                name = f"{(sign or b'+').decode()}{axis.decode().lower()}"
                found.setdefault(word.decode().lower(), name)
    up, forward = found.get("up"), found.get("forward")
    if up is None or forward is None or up[1] == forward[1]:
        return UNSAID
    return SaidAxes(up, "file", forward, "file")


def oriented(source: str, mesh: Mesh, said: SaidAxes, axes: MeshAxes) -> Mesh:
    """Return a mesh of a file in the ground frame, and in words how its axes were taken."""
    chosen = _chosen(mesh, said, axes)
    triangles = _turned(mesh.triangles, chosen.up, chosen.forward)
    if axes.scale != 1.0:
        triangles = triangles * axes.scale
        if not np.isfinite(triangles).all():
            raise InputError(source, "scale", "finite coordinates", shown(axes.scale))
    if any(axes.rotation_deg or ()):
        turn = Pose.from_degrees((0, 0, 0), axes.rotation_deg or ())
        triangles = rotate(turn.ground_from_sensor, triangles)
    return Mesh(triangles, mesh.parts, mesh.part_names, _words(chosen))


def _chosen(mesh: Mesh, said: SaidAxes, axes: MeshAxes) -> SaidAxes:
    """What is asked for, else what the file says, else a guess, else the default."""
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
    """What a file says, but for what a study says otherwise."""
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
    """The same with forward across up: a default that is not gives way."""
    if said.up[1] != said.forward[1]:
        return said
    return said._replace(forward="+x" if said.up[1] != "x" else "+z", forward_by="")


def _turned(triangles: Floats, up: str, forward: str) -> Floats:
    """Triangles with forward, left, up as x, y, z; corners are only exchanged and mirrored."""
    if (up, forward) == ("+z", "+x"):
        return triangles
    ahead, above = _unit(forward), _unit(up)
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


def _words(chosen: SaidAxes) -> str:
    """How the axes were taken, in words; none where the file is in the ground frame."""
    if chosen == OURS:
        return ""
    up_by, forward_by = chosen.up_by or "assumed", chosen.forward_by or "assumed"
    return f"faces {chosen.forward} ({forward_by}), up is {chosen.up} ({up_by})"

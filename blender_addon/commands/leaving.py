"""What only Blender can leave in a folder of results: the scene, and a picture of it."""

from __future__ import annotations

from pathlib import Path

import bpy

from .. import bridge, stale
from ..engine import pe, studies

OPTIMIZED, REVIEW = studies.OPTIMIZED, studies.REVIEW
ENDS = {
    b"\x89PNG": b"IEND\xaeB`\x82",
    b"\x28\xb5\x2f\xfd": b"\xb1\xea\x92\x8f",
}
"""What ends a file that begins so: a PNG, and a compressed .blend (zstd with a table of frames)."""


def leave_scene(outcome: pe.Outcome, data: dict, folder: Path, *, render: bool) -> None:
    """Write what only Blender can: the scene with the sensors moved, and the picture."""
    scene = bpy.context.scene
    if outcome.kind == "optimize":
        bridge.place_rig(scene, outcome.study.rig)
        taken = stale.fingerprint(scene)
        bridge.store_outcome(scene, outcome, taken.text)
        bridge.choose_variant(scene, bridge.keep_search(scene, outcome, taken.surroundings))
        studies.add_to_result(data, folder, {OPTIMIZED: save_copy})
    if render:
        from .. import review  # only who wants a picture pays for it

        def picture(path: Path) -> None:
            try:
                review.render_review(scene, outcome.study, outcome, path)
            except RuntimeError as error:
                raise pe.InputError(path, "file", "a picture", error) from None
            complain_unless_whole(path)

        studies.add_to_result(data, folder, {REVIEW: picture})


def leave_front(found: pe.TradeOff, folder: Path) -> None:
    """Write the scene with the designs of a front as variants."""
    scene = bpy.context.scene
    bridge.keep_front(scene, found, stale.fingerprint(scene).surroundings)
    with studies.FileSet(folder) as files:
        files.add(OPTIMIZED, save_copy)


def save_copy(path: Path) -> None:
    """Save the open scene to another file; the open file stays as it is."""
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=True)
    except RuntimeError as error:
        raise pe.InputError(path, "file", "a place to write to", error) from None
    complain_unless_whole(path)


def complain_unless_whole(path: Path) -> None:
    """Raise `InputError` when a file has not the end that its beginning promises.

    On a full disk Blender leaves half a file, or none, and says nothing.
    """
    data = path.read_bytes() if path.is_file() else b""
    end = next((end for begin, end in ENDS.items() if data.startswith(begin)), b"")
    if not data or not data.endswith(end):
        found = f"that {len(data)} bytes of it could be written"
        raise pe.InputError(path, "file", "room to write to", found)

"""Pictures of variants, as icons of Blender: made by Compare, and kept with a variant's figures."""

import base64
import hashlib
from pathlib import Path

import bpy
import bpy.utils.previews

_previews: list[bpy.utils.previews.ImagePreviewCollection] = []


def icon_of(picture: str) -> int:
    """Return the icon of a PNG file in base 64; 0 for none."""
    if not picture:
        return 0
    if not _previews:
        _previews.append(bpy.utils.previews.new())
    name = hashlib.sha256(picture.encode()).hexdigest()[:16]
    if name not in _previews[0]:
        path = Path(bpy.app.tempdir) / f"variant_{name}.png"
        path.write_bytes(base64.b64decode(picture))
        _previews[0].load(name, str(path), "IMAGE")
    return int(_previews[0][name].icon_id)


def clear(*_: object) -> None:
    """Release the icons: the file or the add-on is closed."""
    while _previews:
        bpy.utils.previews.remove(_previews.pop())

"""Make the library of sensors for the asset browser: `python make_sensors.py` with bpy 4.2.

One asset for every LiDAR and camera of the catalogue, by kind and maker: a mesh of its housing that
is a ready sensor, with tags and a preview. Later versions of Blender read what 4.2 writes.
"""

from __future__ import annotations

import argparse
import sys
import uuid
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

from blend_file import save  # noqa: E402
from curves import Array  # noqa: E402
from sensor_previews import PIXELS, Studio  # noqa: E402

import blender_addon  # noqa: E402
import pe_core as pe  # noqa: E402
from blender_addon.view.housing import housing_mesh  # noqa: E402

FOLDER = HERE.parent / "blender_addon" / "assets"
BLEND = "sensors.blend"
CATALOGS = "blender_assets.cats.txt"
HEADER = "# Catalogues of sensors.blend, written by make_sensors.py.\n\nVERSION 1\n\n"
NAMESPACE = uuid.UUID("8d1f2c1e-6a3b-4b0e-9f0a-5f1c7f3e9a41")
KINDS = {"lidar": "LiDAR", "camera": "Camera"}
MAKERS = {"paper": "Paper", "cameras": "Data sets and modules", "robosense": "RoboSense"}
"""Files of the catalogue that are no maker's plain name."""
MAX_RAYS = 33


def main() -> None:
    """Read the arguments, make the assets and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder to write to")
    folder = parser.parse_args().out.resolve()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    try:
        paths = make_assets()
        save(folder / BLEND)
    finally:
        blender_addon.unregister()
    (folder / CATALOGS).write_text(HEADER + "".join(catalog_line(p) for p in sorted(paths)))


def make_assets() -> set[str]:
    """Make all assets in the open file; return the paths of their catalogues."""
    paths = set()
    studio = Studio()
    for entry in pe.catalog.entries().values():
        if entry.kind in KINDS:
            obj = make_sensor(entry)
            give_preview(obj, studio, entry)
            paths.add(path_of(entry))
    studio.close()
    return paths | {path.split("/")[0] for path in paths}


def make_sensor(entry: pe.catalog.Entry) -> bpy.types.Object:
    """Make one asset: an object that is a sensor of this model."""
    obj = bpy.data.objects.new(short_name(entry), housing_mesh(entry.name))
    obj.perception_entropy.model = entry.name
    obj.perception_entropy.is_sensor = True
    obj.perception_entropy.stands_when_dropped = True
    obj.asset_mark()
    data = obj.asset_data
    data.catalog_id = catalog_id(path_of(entry))
    data.author = "perception-entropy contributors"
    data.license = "CC0-1.0"
    data.description = description(entry)
    for tag in tags(entry):
        data.tags.new(tag, skip_if_exists=True)
    return obj


def short_name(entry: pe.catalog.Entry) -> str:
    """Its name without the maker's, unless that is another one's: below it stands the maker."""
    maker = path_of(entry).split("/")[1]
    short = entry.name.removeprefix(f"{maker} ")
    return short if short[0].isupper() and short not in pe.catalog.names() else entry.name


def path_of(entry: pe.catalog.Entry) -> str:
    """Path of the catalogue that an entry belongs to: kind/maker."""
    stem = Path(entry.file).stem
    return f"{KINDS[entry.kind]}/{MAKERS.get(stem, stem.capitalize())}"


def catalog_id(path: str) -> str:
    """A catalogue's id, the same every time."""
    return str(uuid.uuid5(NAMESPACE, path))


def catalog_line(path: str) -> str:
    """A catalogue's line in Blender's file of them."""
    return f"{catalog_id(path)}:{path}:{path.replace('/', '-')}\n"


def description(entry: pe.catalog.Entry) -> str:
    """What it is, how large and who says so."""
    housing = pe.catalog.housing(entry.name)
    size = "Housing of a typical size" if housing is None else f"Housing: {housing.source}"
    return f"{figures(entry)}. {size}"


def figures(entry: pe.catalog.Entry) -> str:
    """What it measures, in short."""
    model = pe.catalog.load(entry.name)
    if entry.kind == "camera":
        return f"{model.width} x {model.height} pixels, {np.degrees(model.hfov):.0f} deg wide"
    low, high = np.degrees([model.elevations.min(), model.elevations.max()])
    reach = f"{model.max_range:g} m"
    return f"{len(model.elevations)} channels, {low:.0f} to {high:+.0f} deg, {reach}"


def tags(entry: pe.catalog.Entry) -> list[str]:
    """Words to search by."""
    kind, maker = path_of(entry).split("/")
    size = "true size" if pe.catalog.housing(entry.name) else "typical size"
    channels = []
    if entry.kind == "lidar":
        channels = [f"{len(pe.catalog.load(entry.name).elevations)} channels"]
    return ["sensor", kind, maker, *channels, size]


def give_preview(obj: bpy.types.Object, studio: Studio, entry: pe.catalog.Entry) -> None:
    """Take the asset's picture and keep it in the file."""
    rays = looks(pe.catalog.load(entry.name))
    picture = studio.picture(obj, entry.kind, rays, entry.kind == "camera")
    preview = obj.preview_ensure()
    preview.image_size = (PIXELS, PIXELS)
    preview.image_pixels_float.foreach_set(picture.astype(np.float32).ravel())


def looks(model: pe.Lidar | pe.Camera) -> Array:
    """(R, 3) directions that show where a model looks: its channels ahead, or its view's sides."""
    if isinstance(model, pe.Camera):
        half = model.hfov / 2.0
        return np.array([[np.cos(a), np.sin(a), 0.0] for a in (-half, half)])
    up = model.elevations
    up = up[np.unique(np.linspace(0, len(up) - 1, min(len(up), MAX_RAYS)).round().astype(int))]
    return np.stack([np.cos(up), np.zeros(len(up)), np.sin(up)], axis=1)


if __name__ == "__main__":
    main()

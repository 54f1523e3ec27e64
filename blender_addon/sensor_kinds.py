"""How the add-on treats each kind of sensor: one table, a row a kind.

A kind that the engine has and this table has not takes the row `OTHER`: without a line of its own
here its sensors are added, placed, defined by a file of their own, searched and shown.
"""

import math
import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from .engine import catalog, kinds, pe, studies

DEFAULT_MODEL = "Pandar64"
LONGEST_LINE = 4096
"""Letters of a line with the keys of a table."""
METRES = studies.Number(0.0, unit="m")
PIXELS = studies.Whole(1)
LINE = studies.Name(max_length=LONGEST_LINE)
ELEVATION = studies.Number(-90.0, 90.0)
AZIMUTH = studies.Number(-360.0, 360.0)
CAN = pe.Housing("cylinder", (0.1, 0.1, 0.09), (0.0, 0.0, 0.045), "typical size")
VISOR = pe.Housing("box", (0.1, 0.13, 0.05), (0.05, 0.0, 0.025), "typical size")
SMALL_BOX = pe.Housing("box", (0.045, 0.03, 0.03), (0.0225, 0.0, 0.0145), "typical size")
RADAR_BOX = pe.Housing("box", (0.03, 0.13, 0.09), (0.015, 0.0, 0.0), "typical size")
MEMBRANE = pe.Housing("box", (0.02, 0.03, 0.03), (0.01, 0.0, 0.0), "typical size")
CAN_FOV = math.radians(200.0)
"""A LiDAR that looks around less than this has its back to something: no window all round."""


@dataclass(frozen=True, slots=True)
class Mount:
    """How sensors of one kind are added.

    `usual` is the model of the kind's button, None for the first of the catalogue. On a roof it is
    at the front edge or over the middle; without a vehicle at `height_m`. `display` and `size_m`
    are its empty's; `stand_off_m` and `outward` are the kind's own.
    """

    usual: str | None
    at_front: bool
    height_m: float
    display: str
    size_m: float
    stand_off_m: float = 0.05
    outward: bool = True


def _figure(default: Any, rule: Any, label: str, text: str, **panel: Any) -> Any:
    return studies.setting(default, rule, text, studies.Panel("", label, **panel), scored=True)


@dataclass(frozen=True, slots=True)
class OwnLidar:
    """Figures of an own LiDAR, whose channels are evenly spread over the field of view."""

    channels: int = _figure(32, studies.Whole(1, 2048), "Channels", "Number of channels")
    elevations: tuple[float, float] = _figure(
        (-25.0, 15.0), studies.Pair(ELEVATION), "Elevation °",
        "Lowest and highest channel in degrees above the horizon",
    )  # fmt: skip
    azimuths: tuple[float, float] = _figure(
        (-180.0, 180.0), studies.Pair(AZIMUTH), "Azimuth °",
        "Begin and end in degrees; positive is left",
    )  # fmt: skip
    azimuth_step: float = _figure(
        0.2, studies.Number(0.001, 360.0), "Azimuth Step °",
        "Angle between two beams of a channel in degrees", precision=3,
    )  # fmt: skip
    min_range: float = _figure(0.0, METRES, "From", "Minimum distance at which a beam counts")
    max_range: float = _figure(
        200.0, METRES, "Range", "Maximum distance at which a beam counts", min=0.01
    )


@dataclass(frozen=True, slots=True)
class OwnCamera:
    """Figures of an own camera."""

    width: int = _figure(1920, PIXELS, "Width", "Horizontal number of pixels")
    height: int = _figure(1080, PIXELS, "Height", "Vertical number of pixels")
    hfov: float = _figure(
        90.0, studies.Number(0.001, 179.9), "Field of View °", "Horizontal field of view in degrees"
    )
    lens: str = _figure(
        "", LINE, "Lens",
        "Instead of the field of view, with the keys of a study: fx = 930, cx = 965, cy = 530, "
        'distortion = { model = "brown-conrady", k1 = -0.16 }. Also min_range_m and max_range_m',
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class OwnTable:
    """A kind without fields in the panel."""

    keys: str = _figure("", LINE, "Keys", "The keys of its table in a study")


@dataclass(frozen=True, slots=True)
class KindRow:
    """How the add-on treats sensors of one kind."""

    mount: Mount
    """How a sensor is added."""
    typical_housing: Callable[[Any], pe.Housing]
    """From a model to a housing for the asset library, where no size of the model is known."""
    own_about: str = "Its table's keys as a study has them"
    own_fields: tuple[str, ...] = ("keys",)
    """Of an own sensor of the kind: its description for a menu, and what the panel shows."""
    has_lens: bool = False
    """Whether a housing is drawn with a lens, not with a window."""
    camera: Callable[[Any], pe.Camera] | None = None
    """From a model to the camera for Blender's view; None without a view."""


def _lidar_housing(model: pe.Lidar) -> pe.Housing:
    low, high = model.horizontal_fov
    return CAN if high - low > CAN_FOV else VISOR


ROWS = {
    "lidar": KindRow(
        Mount(DEFAULT_MODEL, at_front=False, height_m=1.8, display="SPHERE", size_m=0.12),
        _lidar_housing,
        own_about="Beams of channels that are evenly spread",
        own_fields=tuple(studies.settings_of(OwnLidar)),
    ),
    "camera": KindRow(
        Mount("Camera 90 deg", at_front=True, height_m=1.5, display="ARROWS", size_m=0.25),
        lambda _model: SMALL_BOX,
        own_about="A pinhole camera with square pixels, or one with a lens of its own",
        own_fields=tuple(studies.settings_of(OwnCamera)),
        has_lens=True,
        camera=lambda model: model,
    ),
    "radar": KindRow(
        Mount("Continental ARS408-21", at_front=True, height_m=0.5, display="CONE", size_m=0.12),
        lambda _model: RADAR_BOX,
        own_about="Modes with their azimuths and ranges, as a study's table has them",
    ),
    "ultrasonic": KindRow(
        Mount("Bosch Ultrasonic 3.1", at_front=True, height_m=0.5, display="CIRCLE", size_m=0.05),
        lambda _model: MEMBRANE,
        own_about="A cone and a range, as a study's table has them",
    ),
}
OTHER = KindRow(
    Mount(usual=None, at_front=True, height_m=1.5, display="ARROWS", size_m=0.25),
    lambda _model: SMALL_BOX,
)
"""Of a kind that has no row."""


def row_of(kind: str) -> KindRow:
    """Return how sensors of a kind are treated."""
    return ROWS.get(kind, OTHER)


def has_view(model: str) -> bool:
    """Whether Blender's view can look through sensors of this model."""
    try:
        return row_of(catalog.load(model).kind).camera is not None
    except pe.InputError:
        return False


def mount_of(kind: str) -> Mount:
    """Return how sensors of a kind are added."""
    mount = row_of(kind).mount
    known = kinds.KINDS.get(kind)
    return mount if known is None else replace(mount, stand_off_m=known.stand_off_m)


def mount_for(model: Any) -> Mount:
    """Return how sensors of a model are added."""
    return replace(mount_of(model.kind), outward=kinds.kind_of(model).outward(model))


def kind_label(kind: str) -> str:
    """Return what people call a sensor of a kind; the kind's name where the engine has none."""
    return kinds.KINDS[kind].label if kind in kinds.KINDS else kind


_items: list[tuple[str, str, str, int]] = []
"""What menus list: Blender reads the texts after the function that made them has returned."""


def own_kinds(_settings: object, _context: object) -> list[tuple[str, str, str, int]]:
    """Return the kinds that an own sensor may be of, as Blender wants a menu. A .blend file holds
    the numbers: those of the kinds with a row are their places in the table, others follow from the
    name."""
    # Of other kinds: the same number in every session, clear of the table's places.
    numbers = {name: 1000 + zlib.crc32(name.encode()) % 2**24 for name in kinds.KINDS}
    numbers |= {name: number for number, name in enumerate(ROWS)}
    rows = kinds.KINDS.items()
    _items[:] = [(name, row.label, row_of(name).own_about, numbers[name]) for name, row in rows]
    return _items

"""The perception model: AP curves by kind of sensor, and the rule for blind sensors.

Whole objects have the curves of their kind (`[ap] model = "paper"`), or those from scans
(`"scans"`): fitted to the detectors of our own study, docs/validity/own; `python -m
studies.detectors --curves` writes them. Those of published LiDAR detectors are fitted to their AP
by range on one vehicle, and hold over range within one rig; that of cameras is fitted to changes of
one published rig (docs/validity/cameras). Kinds and classes that a model lacks keep the paper's.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Any

from ..base.arrays import ReadOnlyDict
from ..base.codec import Node, read, read_value
from ..base.errors import InputError, shown
from ..base.files import decode_text, read_bytes
from ..base.setting import OneOf, Panel, Part, check_settings, setting, settings_of
from ..base.table_reader import load_toml
from ..base.values import A_NAME, choice
from ..metric.entropy import ApCurve
from ..metric.frames import Frames
from .kind import KINDS, ClassCurves, kind_named

PAPER = "paper"
SCANS = "scans"
BEVFUSION = "bevfusion"
CENTERPOINT = "centerpoint"
CAMERA_RIGS = "camera_rigs"
CURVE_MODELS = (PAPER, SCANS, BEVFUSION, CENTERPOINT, CAMERA_RIGS)
MODEL: str = setting(
    PAPER,
    OneOf(CURVE_MODELS),
    "AP curves of whole objects",
    Panel(
        "ap_model",
        "Object AP",
        menu=(
            ("Publications", "Fitted to published detectors, or converted from the paper's curves"),
            ("Scans", "LiDARs: fitted to detectors that this project trained on simulated scans"),
            ("BEVFusion-L", "LiDARs: fitted to published AP by range, within one rig"),
            ("CenterPoint", "LiDARs: fitted to published AP by range, within one rig"),
            ("Camera Rigs", "Cameras, cars alone: fitted to changes of one published rig"),
        ),
    ),
    scored=True,
)
"""The field of `PerceptionModel`."""
FILE = Path(__file__).with_name("scans.toml")
DETECTORS_FILE = FILE.with_name("detectors.toml")
BLIND_RULES = ("floor", "literal")
SOURCE = "perception model"


@cache
def scan_curves() -> ClassCurves:
    """Return the curves from scans, by kind and class, of the file that is part of the engine."""
    tables = load_toml(FILE, "curves", decode_text(read_bytes(FILE)))
    found: ClassCurves = read_value(ClassCurves, Node(tables["curves"], FILE.name, "curves"))
    return found


@dataclass(frozen=True, slots=True)
class DetectorCurve:
    """A curve of a published detector: root of the mean square error of AP, span of m.

    `a_interval` has the 95 % interval of a where the fit has one.
    """

    curve: Annotated[ApCurve, Part(inline=True)]
    rmse: float
    m: tuple[float, float]
    a_interval: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Detector:
    """A published detector: its curves by kind and class, their source, where they hold."""

    label: str
    source: str
    trust: str
    rows: Annotated[Mapping[str, Mapping[str, DetectorCurve]], Part(inline=True)]


@cache
def detectors() -> Mapping[str, Detector]:
    """Return the published detectors of the file that is part of the engine, by model."""
    tables = load_toml(DETECTORS_FILE, "curves", decode_text(read_bytes(DETECTORS_FILE)))
    node = Node(tables, DETECTORS_FILE.name)
    return {model: read(Detector, node.at(model)) for model in tables}


def curve_source(model: str) -> str:
    """Return where the curves of objects of a model are from, and where they hold."""
    if (known := detectors().get(model)) is not None:
        return f"{known.label}, {known.trust}; {known.source}"
    if model == SCANS:
        return "of LiDARs, fitted to detectors on simulated scans (docs/validity/own)"
    return "fitted to published detectors, or derived from those of voxels by size"


def fitted_curves(model: str) -> ClassCurves:
    """Return the curves that a model has in place of the kinds' own, by kind and class."""
    if model == SCANS:
        return scan_curves()
    rows = detectors()[model].rows if model in detectors() else {}
    return {kind: {n: row.curve for n, row in own.items()} for kind, own in rows.items()}


@dataclass(frozen=True, init=False, repr=False)
class PerceptionModel:
    """The AP curve of every kind of sensor, and how late fusion takes sensors that see nothing.

    `InputError` when there is no kind or rule of a name, or a curve is not an `ApCurve`.

    Parameters
    ----------
    blind : {"floor", "literal"}
        "floor": a sensor that sees nothing changes nothing. "literal": the literal formula (eq. 7),
        in which a blind sensor changes the result.
    objects : mapping of kind to mapping of class to ApCurve
        Curves of whole objects, m counted on the object, in place of the model's.
    model : {"paper", "scans", "bevfusion", "centerpoint", "camera_rigs"}
        Curves of the other objects: the kind's own, or those fitted to detectors where there are.
    frames : Frames, optional
        Frames that an entropy is of, and the process noise between them; one frame by default.
    **curves : ApCurve
        By kind, ``lidar=ApCurve(0.2, 0.5)``; a kind's own by default. They are attributes as well:
        ``model.lidar`` is ``model.curve("lidar")``.
    """

    blind: str
    other_curves: Mapping[str, ApCurve]
    """Curves by kind, only those that differ from the kind's own."""
    objects: ClassCurves
    model: str = MODEL
    frames: Frames | None = None

    def __init__(
        self,
        blind: str = "floor",
        *,
        objects: ClassCurves | None = None,
        model: str = PAPER,
        frames: Frames | None = None,
        **curves: ApCurve,
    ) -> None:
        put = object.__setattr__
        put(self, "frames", frames)
        put(self, "model", model)
        check_settings(self, "ap")
        put(self, "blind", choice("fusion", "blind", blind, BLIND_RULES))
        put(self, "other_curves", _checked_curves(curves))
        put(self, "objects", _checked_objects(objects or {}))

    def __getattr__(self, kind: str) -> ApCurve:
        if kind in KINDS:
            return self.curve(kind)
        raise AttributeError(kind)

    def curve(self, kind: str) -> ApCurve:
        """Return the AP curve of a kind of sensor."""
        return self.other_curves.get(kind) or kind_named(kind, SOURCE).curve

    def object_curve(self, kind: str, name: str) -> ApCurve:
        """Return the AP curve of whole objects of a class, by the beams or pixels on each.

        `InputError` when there is none.
        """
        own_curves = kind_named(kind, SOURCE).object_curves
        fitted = fitted_curves(self.model).get(kind, {})
        given = self.objects.get(kind, {}).get(name)
        curve = given or fitted.get(name) or own_curves.get(name)
        if curve is None:
            field = f"[ap.objects.{kind}.{name}]"
            expected = f"a and b of {name!r} as an object (docs/howto/own_detector.md)"
            raise InputError(SOURCE, field, expected, "none")
        return curve

    def of_class(self, name: str) -> "PerceptionModel":
        """Return this with the process noise of one class, for frames."""
        if self.frames is None:
            return self
        return self.with_model(self.model, self.frames.of_class(name))

    def with_model(self, model: str, frames: Frames | None = None) -> "PerceptionModel":
        """Return this with the curves of objects of another model, over frames if any are given."""
        own: Any = {"objects": self.objects, "model": model, "frames": frames, **self.other_curves}
        return PerceptionModel(self.blind, **own)

    @property
    def curves(self) -> dict[str, ApCurve]:
        """The curve of every registered kind."""
        return {kind: self.curve(kind) for kind in KINDS}

    def __repr__(self) -> str:
        curves = "".join(f", {kind}={curve!r}" for kind, curve in self.other_curves.items())
        objects = f", objects={dict(self.objects)!r}" if self.objects else ""
        own = {name: getattr(self, name) for name in settings_of(PerceptionModel)}
        changed = {n: v for n, v in own.items() if v != settings_of(PerceptionModel)[n].default}
        more = "".join(f", {name}={value!r}" for name, value in changed.items())
        return f"PerceptionModel(blind={self.blind!r}{curves}{objects}{more})"


def _checked_curves(curves: Mapping[str, ApCurve]) -> Mapping[str, ApCurve]:
    """Return the curves that differ from those of their kinds."""
    for name, curve in curves.items():
        kind_named(name, SOURCE)
        if not isinstance(curve, ApCurve):
            raise InputError(SOURCE, name, "an ApCurve", shown(curve))
    return ReadOnlyDict({k: c for k, c in curves.items() if c != kind_named(k, SOURCE).curve})


def _checked_objects(objects: ClassCurves) -> ClassCurves:
    """Return read-only curves by kind and class, without kinds that have none."""
    if not isinstance(objects, Mapping):
        raise InputError(SOURCE, "objects", "curves by kind", shown(objects))
    for kind, curves in objects.items():
        kind_named(kind, SOURCE, "objects")
        for name, curve in curves.items():
            A_NAME.checked(SOURCE, f"objects of {kind}", name)
            if not isinstance(curve, ApCurve):
                raise InputError(SOURCE, f"objects.{kind}.{name}", "an ApCurve", shown(curve))
    return ReadOnlyDict({kind: curves for kind, curves in objects.items() if curves})

"""What the figures rest on, and what they do not say: AP curves, prior, validity, limits."""

from __future__ import annotations

from collections.abc import Iterator

from ..engine import kinds, metric, pe
from ..figures import joined, number
from ..markup import Markup, escaped, table
from ..reviewed import Reviewed
from ..section import Section

PAPER = "Ma, Liu and Li, “Perception Entropy”, ICRA 2021"
SOURCES = {
    metric.POINTPILLARS: f"PointPillars on KITTI, moderate; {PAPER}",
    metric.RTM3D: f"RTM3D on KITTI, moderate; {PAPER}",
}
"""Where the shipped curves are from."""
PRIORS = {
    "road": (
        "the road's: positions of each class fitted to the boxes that CenterPoint finds in the 150 "
        "validation scenes of nuScenes; sizes from nuScenes, Argoverse 2 and Waymo"
    ),
    "highway": (
        "the motorway's: distances fitted to KITTI tracking and Argoverse 2; lanes and the shares "
        "of the classes are choices, not data"
    ),
    "uniform": "uniform: every voxel of the space counts alike, whatever is met there",
    "boxes": "labelled boxes of the study's own",
}
VALIDITY = "over both papers, no score can be told from chance"
"""The verdict of docs/validity, in its own words."""
VALIDITY_PAGE = "docs/validity/README.md"


def basis(each: tuple[Reviewed, ...]) -> Section:
    """Return where AP curves and prior come from, and the limits of the figures; alike for all."""
    limits = "".join(f"<li>{line}</li>" for line in _limits(each))
    inside = (
        f"{_curves(each)}<p>{_prior(each[0])}</p><h3>What the figures do not say</h3>"
        f'<ul class="plain limits">{limits}</ul>'
    )
    return Section("basis", "What it rests on", inside)


def _curves(each: tuple[Reviewed, ...]) -> str:
    """Return the AP curves that turn beams and pixels into detection."""
    model = each[0].found.model
    sensors = [sensor for one in each for sensor in one.rig]
    there = dict.fromkeys(sensor.kind for sensor in sensors)
    labels = {sensor.kind: kinds.kind_of(sensor).label for sensor in sensors}
    rows = [_curve(labels[name], model.curve(name)) for name in there]
    own = {(s.name, s.curve) for s in sensors if s.curve is not None}
    rows += [_curve(name, curve) for name, curve in sorted(own, key=lambda item: item[0])]
    title = "AP curves: the AP of a voxel that m beams or pixels meet is a ln m + b, clipped"
    shown = table(title, ("", "a", "b", "from"), rows, css="words")
    if each[0].after.objects is None:
        return shown
    whose = "the study's own" if model.objects else "carried over from those above by size"
    return f'{shown}<p class="note">Curves of whole objects, by class: {whose}.</p>'


def _curve(whose: str, curve: pe.ApCurve) -> list[str]:
    source = SOURCES.get(curve, "given by the study")
    return [whose, number(curve.a, 3), number(curve.b, 3), source]


def _prior(one: Reviewed) -> Markup:
    prior = one.found.prior
    said = PRIORS.get(prior.model, prior.model)
    if prior.boxes is not None:
        said = f"{said} ({escaped(prior.boxes.source)})"
    names = joined([escaped(name) for name in prior.class_names])
    focus = f" {len(prior.focus)} focus regions weigh more." if prior.focus else ""
    return Markup(f"The prior, where objects are expected, is {said}. Classes: {names}.{focus}")


def _limits(each: tuple[Reviewed, ...]) -> Iterator[str]:
    """Yield what a reader may not take from the figures."""
    yield (
        "Entropy compares placements under these curves and this prior. It is no AP, no "
        "probability of detection, and not comparable with entropies of another space or prior."
    )
    yield (
        f"Whether scores rank placements as trained detectors do is open: {VALIDITY} (16 published "
        f"placements, simulated). The project's page on it is <code>{VALIDITY_PAGE}</code>."
    )
    yield (
        "Geometry alone is computed: beams and pixels that meet a place. Weather, light, "
        "reflectivity, motion, dirt, calibration, latency and the detector's failures are not."
    )
    if not each[0].found.targets.traffic:
        yield "Other road users hide nothing here: only the vehicle itself does."
    if any(one.vehicle is None for one in each):
        yield "Without a vehicle nothing hides anything: the figures are too good."
    yield _ends(each[0].found.space)


def _ends(space: pe.PerceptionSpace) -> str:
    """Say where the space ends: what is seen beyond it is not counted."""
    (x0, x1), (y0, y1) = space.x, space.y
    return (
        f"Places are evaluated {number(x1, 0)} m ahead, {number(-x0, 0)} m behind, "
        f"{number(y1, 0)} m to the left and {number(-y0, 0)} m to the right, up to "
        f"{number(space.z[1], 1)} m over the ground; what is seen beyond counts for nothing."
    )

"""Traceability: sources and limits of the numbers, and everything needed to reproduce them."""

from __future__ import annotations

import platform
from collections.abc import Iterator

import numpy as np

import pe_core as pe
from pe_core import metric
from pe_core import sensors as kinds
from pe_core import study as studies

from ... import advice, jobs
from ..markup import Markup, escaped, joined, number, table
from ..report_context import ReportContext, Section

PAPER = "Ma, Liu and Li, “Perception Entropy”, ICRA 2021"
CURVE_SOURCES = {
    metric.POINTPILLARS: f"PointPillars on KITTI, moderate; {PAPER}",
    metric.RTM3D: f"RTM3D on KITTI, moderate; {PAPER}",
}
"""Sources of the AP curves that come with the engine."""
PRIOR_SOURCES = {
    "road": (
        "that of a road: positions of each class are fitted to the boxes that CenterPoint finds in "
        "the 150 validation scenes of nuScenes; sizes are from nuScenes, Argoverse 2 and Waymo"
    ),
    "highway": (
        "that of a motorway: distances are fitted to KITTI tracking and Argoverse 2; lanes and the "
        "shares of the classes are assumptions, not data"
    ),
    "uniform": "uniform: every voxel of the space has the same weight",
    "boxes": "given by labelled boxes of the study",
}
OWN_STUDY = (
    "detectors of our own find more at a better score in simulated LiDAR scans, within one rig; "
    "entropy can prefer a rig with a blind sector"
)
VALIDITY = "over both papers, no score has a significant correlation"
"""The conclusion of `VALIDITY_PAGE`, word for word."""
VALIDITY_PAGE = "docs/validity/README.md"


def assumptions(contexts: tuple[ReportContext, ...]) -> Section:
    """Return the sources of AP curves and prior, and the limits; they are the same for all."""
    limits = "".join(f"<li>{line}</li>" for line in _limits(contexts))
    inside = (
        f"{_curve_table(contexts)}<p>{_prior(contexts[0])}</p><h3>Limits</h3>"
        f'<ul class="plain limits">{limits}</ul>'
    )
    return Section("basis", "Assumptions", inside)


def _curve_table(contexts: tuple[ReportContext, ...]) -> str:
    """Return a table of the AP curves, of kinds and of single sensors."""
    model = contexts[0].study.model
    sensors = [sensor for context in contexts for sensor in context.rig]
    kind_names = dict.fromkeys(sensor.kind for sensor in sensors)
    labels = {sensor.kind: kinds.kind_of(sensor).label for sensor in sensors}
    rows = [_curve_row(labels[name], model.curve(name)) for name in kind_names]
    own_curves = {(s.name, s.curve) for s in sensors if s.curve is not None}
    rows += [
        _curve_row(name, curve) for name, curve in sorted(own_curves, key=lambda item: item[0])
    ]
    title = "AP curves: the AP of a voxel with m beams or pixels is a ln m + b, clipped to 0 to 1"
    curves = table(title, ("", "a", "b", "source"), rows, css="words")
    if contexts[0].after.objects is None and contexts[0].outcome.in_traffic is None:
        return curves
    source = (
        "of LiDARs, fitted to detectors on simulated scans (docs/validity/own)"
        if model.model == kinds.SCANS
        else "fitted to published detectors, or derived from those above by size"
    )
    own = '<p class="note">Those that the study gives come first.</p>' if model.objects else ""
    return f'{curves}<p class="note">Curves of whole objects, by class: {source}.</p>{own}'


def _curve_row(name: str, curve: pe.ApCurve) -> list[str]:
    source = CURVE_SOURCES.get(curve, "given by the study")
    return [name, number(curve.a, 3), number(curve.b, 3), source]


def _prior(context: ReportContext) -> Markup:
    prior = context.study.prior
    source = PRIOR_SOURCES.get(prior.model, prior.model)
    if prior.boxes is not None:
        source = f"{source} ({escaped(prior.boxes.source)})"
    names = joined([escaped(name) for name in prior.class_names])
    focus = f" {len(prior.focus)} focus regions have a higher weight." if prior.focus else ""
    return Markup(f"The prior of the objects' positions is {source}. Classes: {names}.{focus}")


def _limits(contexts: tuple[ReportContext, ...]) -> Iterator[str]:
    """Yield what readers must not conclude from the numbers."""
    yield (
        "Entropy compares placements for these curves and this prior. It is neither an AP nor a "
        "probability of detection, and cannot be compared across spaces or priors."
    )
    yield (
        "Whether scores rank placements as trained detectors do on real roads is an open "
        f"question: {OWN_STUDY}; "
        f"{VALIDITY} (16 published placements, simulated). Details: <code>{VALIDITY_PAGE}</code>."
    )
    yield (
        "The score is geometric: it counts beams and pixels. Weather, light, reflectivity, motion, "
        "dirt, calibration, latency and failures of the detector are not modelled."
    )
    if not contexts[0].study.targets.traffic:
        yield "Only the vehicle itself occludes; other road users do not."
    if any(context.vehicle is None for context in contexts):
        yield "Without a vehicle nothing is occluded: the values are too good."
    yield _space_limits(contexts[0].study.space)


def _space_limits(space: pe.PerceptionSpace) -> str:
    """Return the limits of the space; objects beyond it do not count."""
    (x0, x1), (y0, y1) = space.x, space.y
    return (
        f"The evaluated space extends {number(x1, 0)} m ahead, {number(-x0, 0)} m behind, "
        f"{number(y1, 0)} m to the left, {number(-y0, 0)} m to the right and up to "
        f"{number(space.z[1], 1)} m above the ground. Objects beyond it do not count."
    )


COPY_SCRIPT = """
for (const button of document.querySelectorAll("button[data-copies]")) {
  button.hidden = false;
  button.addEventListener("click", async () => {
    const text = document.getElementById(button.dataset.copies);
    const range = document.createRange();
    range.selectNodeContents(text);
    const chosen = window.getSelection();
    chosen.removeAllRanges();
    chosen.addRange(range);
    try {
      await navigator.clipboard.writeText(text.textContent);
      button.textContent = button.dataset.copied;
    }
    catch {
      const copied = document.execCommand("copy");
      button.textContent = copied ? button.dataset.copied : button.dataset.selected;
    }
  });
}
"""


def rerun(context: ReportContext) -> Section:
    """Return command line, versions, digests and the study itself."""
    inside = f"{_command(context)}{_version_table(context)}{_study_files(context)}"
    return Section("again", "Reproduction", inside, {}, (COPY_SCRIPT,))


def _command(context: ReportContext) -> str:
    """Return the command line as it was given, and one for the study below."""
    given = ""
    if context.command:
        given = f"<p>Where its files are, run</p><pre>{escaped(context.command)}</pre>"
    command = (
        "pe optimize study.toml -o DIR" if context.was_searched else "pe review study.toml -o DIR"
    )
    return (
        f"{given}<p>Or save the study below as study.toml, with the files it names beside it, and "
        f"run</p><pre>{command}</pre>"
    )


def _version_table(context: ReportContext) -> str:
    vehicle_line = context.study.vehicle_line
    rows = [
        ["perception-entropy", pe.__version__],
        ["Python, NumPy", f"{platform.python_version()}, {np.__version__}"],
        *([name, version] for name, version in context.versions.items()),
        ["Scored on", _samples_text(context)],
        *([["Seed", str(context.start.search.seed)]] if context.was_searched else []),
        ["Study as given, SHA-256", _digest(jobs.fingerprint(context.start))],
        ["Vehicle", vehicle_line or "none: nothing is occluded"],
        ["Vehicle, SHA-256", _digest(studies.vehicle_digest(context.vehicle) or "")],
    ]
    return table("Versions and inputs", ("item", "value"), rows, css="words")


def _samples_text(context: ReportContext) -> str:
    score, space = context.after, context.study.space
    if score.objects is not None:
        sample = advice.objects_looked_at(score.objects)
        return f"{sample}, standard error {score.stderr:.4f} nats"
    whole = "all " if not score.stderr else "a sample of "
    error = f", standard error {score.stderr:.4f} nats" if score.stderr else ""
    return f"{whole}{score.voxels:,} voxels, of {space.interval:g} m{error}"


def _digest(text: str) -> str | Markup:
    return Markup(f"<code>{escaped(text)}</code>") if text else "none"


def _study_files(context: ReportContext) -> str:
    """Return the file of the study as it was given; after a search also of the best placement."""
    if not context.was_searched:
        return _study_file(context.start, f"study-{context.key}", "The study")
    given = _study_file(context.start, f"study-{context.key}", "The study as given")
    best = _study_file(context.study, f"found-{context.key}", "The study with the best placement")
    return given + best


def _study_file(study: pe.Study, name: str, title: str) -> str:
    """Return a study's file as text, with a button that copies it."""
    text = jobs.study_writers(study, studies.STUDY)[studies.STUDY]
    assert isinstance(text, bytes)
    lines = "\n".join(escaped(line) for line in text.decode().split("\n"))
    return (
        f'<h3>{title}</h3><button type="button" data-copies="{name}" data-copied="Copied" '
        'data-selected="Selected" hidden>Copy</button>'
        f'<pre id="{name}" tabindex="0">{lines}</pre>'
    )

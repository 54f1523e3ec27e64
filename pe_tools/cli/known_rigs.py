"""`pe new --rig`: known rigs and templates, listed, described, or written as a study."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

from pe_core import catalog
from pe_core.base.files import require_new
from pe_core.catalog import KnownRig, RigTemplate
from pe_core.scene import Rig, named_places
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_core.study import Study, read_rig_line, save_study

from ..formats import MeshAxes
from ..graphics import place_tints
from ..wording import aligned
from .answers import RigsAnswer
from .exchange_verbs import wrote
from .found_vehicle import OF_MESH, FoundVehicle, asked_keys, find_vehicle
from .options import PLACEMENTS
from .terminal import DONE, Answer, answered, tell

PUBLISHED, STRETCHED, PLACES = PLACEMENTS
STANDS = {
    PUBLISHED: "as published, about the vehicle's centre",
    STRETCHED: "stretched onto this vehicle's box",
    PLACES: "on named places of this vehicle",
}
"""How a rig stands, in words, by placement."""
OF_TEMPLATE = ("place", "model", "yaw_deg", "pitch_deg")
"""Of a sensor of a template."""


def new_of_rig(args: argparse.Namespace) -> Answer:
    """Write the study of a known rig, or of a rig's line; without an output list or describe."""
    is_line = "=" in args.rig
    if args.output is None:
        if is_line:
            args.usage_error("expected -o STUDY, the study to write")
        chosen = [catalog.rig_named(args.rig)] if args.rig else _all()
        shown = RigsAnswer(rigs=tuple(map(_table, chosen)))
        return answered(args, shown, _described(chosen[0]) if args.rig else _listed()), DONE
    if not args.rig:
        args.usage_error("expected --rig NAME, a rig to write")
    asked = asked_keys(args, OF_MESH)
    rig = read_rig_line(args.rig) if is_line else catalog.rig_named(args.rig)
    found = None if args.file is None else find_vehicle(args, asked)
    output = Path(args.output)
    require_new(output, replace=args.replace)
    placed = rig if isinstance(rig, Rig) else _placed(rig, found, args.placement)
    study = Study(
        placed,
        None if found is None else found.vehicle,
        samples=FIRST_SAMPLES,
        mesh=None if found is None else found.mesh,
        axes=MeshAxes() if found is None else found.axes,
    )
    save_study(study, output)
    return wrote(output, study, args), DONE


def _placed(rig: KnownRig | RigTemplate, found: FoundVehicle | None, placement: str | None) -> Rig:
    """Return a known rig on a vehicle, and tell how it stands there."""
    vehicle = None if found is None else found.vehicle
    if isinstance(rig, RigTemplate):
        placed = catalog.rig_on(rig, vehicle)
        tints = place_tints((each.name, each.kind) for each in placed)
        tell(f"{rig.title}: {STANDS[PLACES]}. {rig.note}")
        return Rig([replace(each, color=tints[each.name]) for each in placed])
    on_it = None if placement == PUBLISHED else vehicle
    places = named_places(on_it) if placement == PLACES and on_it is not None else None
    stands = STRETCHED if on_it is not None and rig.size is not None else PUBLISHED
    tell(f"{rig.title}: {STANDS[stands if places is None else PLACES]}. {rig.note}")
    return catalog.rig_on(rig, on_it, places)


def _all() -> list[KnownRig | RigTemplate]:
    """Return known rigs, then templates."""
    return [*catalog.known_rigs().values(), *catalog.templates().values()]


def _table(rig: KnownRig | RigTemplate) -> dict[str, Any]:
    """Return a rig as plain data: poses in m and degrees, of a template its places."""
    if isinstance(rig, RigTemplate):
        rows = [dict(zip(OF_TEMPLATE, row, strict=True)) for row in rig.sensors]
        return {"name": rig.key, "title": rig.title, "note": rig.note, "sensors": rows}
    rows = [
        {"name": each.name, "model": each.model}
        | {"position": each.pose.position, "rotation": each.pose.rotation_deg}
        for each in rig.sensors
    ]
    own = {
        key: getattr(rig, key) for key in ("title", "vehicle", "size", "origin", "source", "note")
    }
    return {"name": rig.key, **own, "sensors": rows}


def _listed() -> list[str]:
    """Return known rigs and templates as a table."""
    rows = [["NAME", "SENSORS", "RIG", "VEHICLE"]]
    for each in catalog.known_rigs().values():
        rows.append([each.key, str(len(each.sensors)), each.title, each.vehicle])
    for key, template in catalog.templates().items():
        rows.append([key, str(len(template.sensors)), f"Template: {template.title}", "any"])
    return aligned(rows)


def _described(rig: KnownRig | RigTemplate) -> list[str]:
    if isinstance(rig, RigTemplate):
        rows = [["place", "model", "yaw, pitch [deg]"]]
        rows += [[place, model, f"{yaw:g}, {pitch:g}"] for place, model, yaw, pitch in rig.sensors]
        return [rig.title, f"note     {rig.note}", "", *aligned(rows)]
    size = "" if rig.size is None else " {:g} x {:g} x {:g} m".format(*rig.size)
    lines = [rig.title, f"vehicle  {rig.vehicle}{size}", f"origin   {rig.origin}"]
    lines += [f"source   {rig.source}", f"note     {rig.note}", ""]
    rows = [["sensor", "model", "x, y, z [m]", "roll, pitch, yaw [deg]"]]
    for each in rig.sensors:
        place = ", ".join(f"{v:.3f}" for v in each.pose.position)
        turn = ", ".join(f"{v:.3f}" for v in each.pose.rotation_deg)
        rows.append([each.name, each.model, place, turn])
    return lines + aligned(rows)

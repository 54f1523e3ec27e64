"""The verb ``rigs``: known rigs, listed, shown, and written as studies."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from .. import catalog
from ..catalog import KnownRig
from ..scene import Vehicle
from ..study import Study, save_study
from .exchanging import new_study
from .status import DONE, Answer
from .terminal import tell


def add_rigs_verb(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``rigs``: the list, one of it, or a study of one."""
    parser = verbs.add_parser("rigs", help="list known rigs, or write one as a study")
    parser.add_argument("name", nargs="?", metavar="NAME", help="a rig's name in the list")
    parser.add_argument("-o", "--output", metavar="STUDY", help="study to write")
    about = "the vehicle's mesh, from the study's folder: sensors are stretched onto it"
    parser.add_argument("--mesh", metavar="FILE", help=about)
    about = "leave sensors where they were published, about the vehicle's centre"
    parser.add_argument("--as-published", action="store_true", help=about)
    parser.add_argument("--replace", action="store_true", help="replace a study that is there")
    parser.set_defaults(function=show_rigs, usage_error=parser.error)


def show_rigs(args: argparse.Namespace) -> Answer:
    """List known rigs, tell of one, or write it."""
    if args.name is None:
        if args.output is not None:
            args.usage_error("expected NAME, a rig to write")
        return "\n".join(_list()), DONE
    rig = catalog.known_rig(args.name)
    if args.output is None:
        return "\n".join(_described(rig)), DONE
    return write_rig(rig, args), DONE


def write_rig(rig: KnownRig, args: argparse.Namespace) -> str:
    """Write a rig as a study, on a mesh or without a vehicle."""
    output, vehicle = new_study(args)
    study = study_of_rig(rig, vehicle, args.mesh, stretched=not args.as_published)
    save_study(study, output)
    tell(f"{rig.title}: {_standing(rig, vehicle, args.as_published)}. {rig.note}")
    return f"wrote {output}: {len(study.rig)} sensor{'s' if len(study.rig) > 1 else ''}"


def study_of_rig(
    rig: KnownRig, vehicle: Vehicle | None = None, mesh: str | None = None, *, stretched: bool
) -> Study:
    """Return a known rig as a study: on a vehicle stretched onto it, or as it was published."""
    return Study(catalog.rig_on(rig, vehicle if stretched else None), vehicle, mesh=mesh)


def _standing(rig: KnownRig, vehicle: Vehicle | None, as_published: bool) -> str:
    if vehicle is None or as_published or rig.size is None:
        return "as published, about the vehicle's centre"
    return "stretched onto this vehicle's box"


def _list() -> list[str]:
    rows = [
        [rig.key, str(len(rig.sensors)), rig.title, rig.vehicle]
        for rig in catalog.known_rigs().values()
    ]
    return _columns([["NAME", "SENSORS", "RIG", "VEHICLE"], *rows])


def _described(rig: KnownRig) -> list[str]:
    size = "" if rig.size is None else " {:g} x {:g} x {:g} m".format(*rig.size)
    lines = [rig.title, f"vehicle  {rig.vehicle}{size}", f"origin   {rig.origin}"]
    lines += [f"source   {rig.source}", f"note     {rig.note}", ""]
    rows = [["sensor", "model", "x, y, z [m]", "roll, pitch, yaw [deg]"]]
    for each in rig.sensors:
        place = ", ".join(f"{v:.3f}" for v in each.pose.position)
        turn = ", ".join(f"{v:.3f}" for v in each.pose.rotation_deg)
        rows.append([each.name, each.model, place, turn])
    return lines + _columns(rows)


def _columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return rows as lines with their cells below each other."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    padded = ([cell.ljust(width) for cell, width in zip(row, widths, strict=True)] for row in rows)
    return ["  ".join(cells).rstrip() for cells in padded]

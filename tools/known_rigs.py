#!/usr/bin/env python3
"""Score every known rig, and write docs/known_rigs.md: half a minute.

usage: tools/known_rigs.py
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
if str(ROOT) not in sys.path:  # run as a script
    sys.path.insert(0, str(ROOT))

import pe_core as pe  # noqa: E402
import pe_tools as pt  # noqa: E402
from pe_core import catalog  # noqa: E402

PAGE = ROOT / "docs" / "known_rigs.md"
SAMPLES = 65_536
WINDOWS = ("rear_window", "windows_left", "windows_right", "windshield")
VEHICLES = {"sedan": WINDOWS, "bus": ("door_windows", *WINDOWS)}
"""The example vehicles, and their parts of glass."""
HIDDEN = 0.9
"""A sensor of which the vehicle stops more is named."""
HEAD = f"""\
# Known rigs

Published rigs and templates, also in Blender: *Variants > Add Rig*.

```sh
pe new --rig                                   # the list
pe new --rig waymo                             # its sensors, its source
pe new car.npz --rig waymo -o study.toml       # stretched onto a vehicle
pe new car.npz --rig robotaxi -o study.toml    # a template on named places
```

A template (`robotaxi`, `truck`, `parking`, `shuttle`) is a start, no product: models on places
found on the mesh: roof, mirrors, grille, bumpers, tailgate. `--placement places` moves known
sensors to them. In Blender *Named Places* shows them as empties to move first.

Scored at default settings on {SAMPLES:,} voxels, in the open and on a vehicle of
`blend_assets`: stretched, or as published where its own vehicle's box is not known.
Entropies in nats, with standard errors; coverage in percent. They are no
verdict on those vehicles. Written by `tools/known_rigs.py`.

| rig | LiDARs | cameras | radars | in the open | coverage | vehicle | on it | coverage | occluded |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
"""


@dataclass(frozen=True)
class ScoredRig:
    """A rig's row: its score in the open, and on a vehicle."""

    key: str
    vehicle: str
    open: pe.Score
    on_vehicle: pe.Score


def vehicle_of(rig: catalog.KnownRig) -> str:
    """Return which example vehicle a rig is scored on."""
    return "bus" if "bus" in rig.key else "sedan"


def read_vehicle(name: str) -> pe.Vehicle:
    """Return an example vehicle."""
    mesh = pt.read_mesh(ROOT / "blend_assets" / f"{name}.npz")
    return pe.Vehicle(mesh.triangles, mesh.parts, mesh.part_names, VEHICLES[name])


def scored(key: str, samples: int = SAMPLES) -> ScoredRig:
    """Score a rig in the open and on its vehicle."""
    rig = catalog.known_rig(key)
    name = vehicle_of(rig)
    studies = [
        pe.Study(catalog.rig_on(rig, vehicle), vehicle, samples=samples)
        for vehicle in (None, read_vehicle(name))
    ]
    return ScoredRig(key, name, *(_score(study) for study in studies))


def _score(study: pe.Study) -> pe.Score:
    job = pt.ScoreJob(study)
    for _ in job:
        pass
    return job.outcome.after


def line(row: ScoredRig) -> str:
    """Return a rig's line of the table."""
    rig = catalog.known_rig(row.key)
    kinds = [catalog.load(each.model).kind for each in rig.sensors]
    hidden = [
        name
        for name, own in row.on_vehicle.per_sensor.items()
        if own.occluded > HIDDEN * own.beams > 0
    ]
    counts = [str(kinds.count(kind)) for kind in ("lidar", "camera", "radar")]
    cells = [f"{rig.title} (`{row.key}`)", *counts]
    cells += [*figures(row.open), row.vehicle, *figures(row.on_vehicle), ", ".join(hidden)]
    return f"| {' | '.join(cells)} |".replace("|  |", "| |")


def figures(score: pe.Score) -> tuple[str, str]:
    """Return entropy and coverage as the table has them."""
    return f"{score.entropy:.3f} ± {score.stderr:.3f}", f"{100.0 * score.coverage:.1f}"


def main() -> int:
    """Write the page."""
    lines = [line(scored(key)) for key in catalog.known_rigs()]
    PAGE.write_text(HEAD + "\n".join(lines) + "\n", "utf-8")
    print(PAGE)
    return 0


if __name__ == "__main__":
    sys.exit(main())

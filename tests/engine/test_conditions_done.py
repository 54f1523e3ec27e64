"""What states are for, as whole runs: the example of a truck, and a parked car.

`tests/addon/test_conditions_done.py` holds the panel, headless Blender and `pe` to the same bits.
"""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_core.study import Conditions, condition_table, save_study
from pe_core.study.requirement_file import preset
from pe_tools.cli.verbs import main
from tests.engine import shapes

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def written(tmp_path, study):
    """The study in a file, with its vehicle beside it."""
    car = study.vehicle
    pt.write_mesh(tmp_path / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    path = tmp_path / "study.toml"
    save_study(replace(study, mesh="car.npz"), path)
    return path


def test_the_example_s_turned_trailer_takes_from_the_mirror_and_corner_of_its_side():
    """Turned to the left its rear is on the right: `examples/truck_trailer`, on its real mesh."""
    study = pe.load_study(EXAMPLES / "truck_trailer" / "decided.toml")
    rows = condition_table(replace(study, samples=1024, requirements=())).rows
    straight, turned = rows
    assert (straight.state, turned.state) == ("trailer straight", "trailer turned")
    covered = {"lidar_right": {"trailer": 0.0449}, "low_right": {"trailer": 0.0102}}
    assert turned.covered == covered  # as in docs/examples/truck_trailer.md
    assert turned.entropy > straight.entropy + 0.1 and turned.coverage < straight.coverage


def parked(radar):
    """A car at the kerb with its driver's door; cameras on its mirror and the wing look back."""
    boxes = [
        shapes.box((-2.0, -0.9, 0.3), (2.0, 0.88, 1.5)),
        shapes.box((-0.2, 0.88, 0.35), (0.8, 0.92, 1.3)),
    ]
    parts = np.repeat([0, 1], [len(b) for b in boxes])
    car = pe.Vehicle(np.concatenate(boxes), parts, ("body", "door_left"))
    camera = pe.Camera("c", 1280, 720, math.radians(50.0))
    mirror = pe.Sensor("mirror", camera, pe.Pose.from_degrees((0.6, 0.97, 1.1), (0, 0, 170)))
    wing = pe.Sensor("wing", camera, pe.Pose.from_degrees((1.2, 0.97, 0.9), (0, 0, 170)))
    corner = pe.Pose.from_degrees((-1.0, 0.95, 0.85), (0, 0, 165))
    side = pe.Sensor("side radar", catalog.load("TI AWR2944 corner"), corner)
    # about its hinge, ahead, the door's rear edge swings out: to the left, clockwise from above
    opened = pe.Motion(["door_*"], (0.0, 0.0, math.radians(-65.0)), (0.8, 0.9, 0.6))
    dooring = replace(
        preset("ncap26_dooring").requirement(), robust_to=pe.requirements.RobustTo(states=("*",))
    )
    return pe.Study(
        pe.Rig([mirror, wing, *[side] * radar]),
        car,
        samples=4096,
        reference=pe.Reference(-1.3, 0.3, 2.6),
        requirements=(dooring,),
        conditions=Conditions([pe.State("shut"), pe.State("door open", [opened])]),
    )


def test_a_parked_car_with_a_door_open_is_held_to_the_dooring_zone(tmp_path, capsys):
    study = parked(radar=False)
    moved = study.conditions.one("door open").vehicle(study.vehicle)
    assert moved.bounds[1][1] > 1.6, "the door is open outwards"
    (verdict,) = study.verdicts()
    assert not verdict.met and verdict.condition == "door open"
    shut = replace(study, conditions=Conditions([study.conditions.states[0]]))
    assert shut.verdicts()[0].met, "with the doors shut the mirror's camera sees the cyclist"
    (verdict,) = parked(radar=True).verdicts()
    assert verdict.met
    row = condition_table(study).rows[1]
    assert row.covered is not None and set(row.covered) == {"wing"}
    assert row.covered["wing"]["door_left"] > 0.3, "the open door is before it"
    path = written(tmp_path, study)
    assert main(["check", str(path), "--json"]) != 0
    (told,) = json.loads(capsys.readouterr().out)["requirements"]
    assert (told["met"], told["condition"]) == (False, "door open")

"""What is timed: our work, and its yardstick in the same process."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import pe_core as pe

from . import literal
from .condition_rows import four_states_in_three_weathers
from .embree import Embree
from .live_rows import live_camera, live_candidate, live_tilted, live_upright
from .many_rows import full_score_of_four_lidars, full_score_of_many, time_against_sensors
from .mesh_rows import read_glb, read_obj, read_ply
from .object_rows import (
    objects_free,
    objects_in_traffic,
    objects_of_a_camera,
    objects_of_a_rig,
    objects_on_car,
)
from .problems import (
    ROOF_LIDAR,
    car,
    grazing_camera,
    plain_study,
    raw_cast,
    rays_of,
    rays_to_voxels,
    two_lidars,
    two_lidars_two_cameras,
)
from .process_rows import answer_to_a_move, mesh_sent, request_of_a_move
from .requirement_rows import nine_presets, nine_presets_preview, twelve_presets_with_shares_preview
from .search_rows import (
    candidate,
    candidates_in_processes,
    candidates_in_traffic,
    search_in_traffic,
)
from .sight_rows import blind_ground, fine_map, live_map, reach, simplify
from .timing import Timing, Work, best, best_in_turn, peak_mb

Position = tuple[float, float, float]


BESIDE: Position = (-7.4, 1.0, 1.2)


def grid_free() -> Timing:
    """A Pandar64 on the grid of 64 million voxels, against the literal loop in C++."""
    return _against_literal(None, "no vehicle")


def grid_on_car() -> Timing:
    """The same, on a vehicle."""
    return _against_literal(car(), "vehicle of 20,000 triangles")


def _against_literal(vehicle: pe.Vehicle | None, label: str) -> Timing:
    study = plain_study(vehicle)
    evaluator = study.evaluator(0)
    ours, entropy = best(lambda: evaluator.entropy(study.rig))
    peak = peak_mb()
    theirs = literal.run(study)
    if theirs and abs(theirs[0] - entropy) > 1e-3:
        raise SystemExit(f"the yardstick says {theirs[0]}, we say {entropy}")
    again, _ = best(lambda: evaluator.entropy(study.rig))
    seconds = theirs and min(theirs[1], literal.run(study)[1])
    work = f"grid score, Pandar64, {label}"
    return Timing(work, min(ours, again), peak, "literal C++, 2 threads", yardstick_s=seconds)


def grid_two_lidars() -> Timing:
    """Two LiDARs, summed early, against one."""
    return _against_one(two_lidars, "two Pandar64")


def grid_two_lidars_two_cameras() -> Timing:
    """Four sensors, fused early and late, against one."""
    return _against_one(two_lidars_two_cameras, "two Pandar40 and two cameras")


def _against_one(several: Callable[[pe.Study], pe.Study], label: str) -> Timing:
    study = plain_study(car())
    evaluator = study.evaluator(0)
    rig = several(study).rig
    ours, theirs = best_in_turn(
        lambda: evaluator.entropy(rig), lambda: evaluator.entropy(study.rig)
    )
    work = f"grid score, {label}, vehicle"
    return Timing(work, ours, peak_mb(), "one Pandar64, vehicle", yardstick_s=theirs)


def full_score() -> Timing:
    """All a grid score tells of four sensors (9 rigs' worth), against all it tells of one."""
    study = plain_study(car())
    evaluator = study.evaluator(0)
    rig = two_lidars_two_cameras(study).rig
    ours, theirs = best_in_turn(lambda: evaluator.score(rig), lambda: evaluator.score(study.rig), 2)
    work = "score of two Pandar40 and two cameras, each sensor alone and failing, zones, map"
    return Timing(work, ours, peak_mb(), "the same of one Pandar64", yardstick_s=theirs)


def samples_free() -> Timing:
    """Score again after one sensor moved, against a full grid score."""
    return _after_a_move(None, "no vehicle")


def samples_on_car() -> Timing:
    """The same, on a vehicle."""
    return _after_a_move(car(), "vehicle")


def _after_a_move(vehicle: pe.Vehicle | None, label: str) -> Timing:
    study = plain_study(vehicle)
    ours, _ = best(_moving(study, study.evaluator(262_144)), 8)
    peak = peak_mb()
    grid, _ = best(lambda: study.evaluator(0).entropy(study.rig), 1)
    work = f"262,144 samples after a move, {label}"
    return Timing(work, ours, peak, "grid score, first", yardstick_s=grid)


def _moving(study: pe.Study, evaluator: pe.Evaluator) -> Work:
    """Return a call that moves the sensor a little and scores again."""
    x, y, z = study.rig.sensors[0].pose.position
    places = iter(np.linspace(0.0, 0.05, 1000))

    def call() -> float:
        moved = study.rig.with_poses([pe.Pose((x + next(places), y, z))])
        return evaluator.entropy(moved)

    return call


def rays() -> Timing:
    """First hits of a frame, against brute force over all triangles (on a part of the rays)."""
    vehicle, directions, position = rays_of(car())
    ours, _ = best(lambda: vehicle.first_hit(position, directions))
    peak = peak_mb()
    some = directions[:: len(directions) // 500]
    brute, _ = best(lambda: raw_cast(vehicle.triangles, position, some), 1)
    rate = len(directions) / ours / 1e6
    work = f"first hit of {len(directions):,} rays ({rate:.1f} million a second)"
    seconds = brute * len(directions) / len(some)
    return Timing(work, ours, peak, "every ray against every triangle", yardstick_s=seconds)


def rays_close() -> Timing:
    """A frame from 3 cm over the roof, against embree on a thread, its tree built beforehand."""
    return _against_embree(car(), (-0.4, 0.02, 1.48), "3 cm over a roof")


def rays_from_roof() -> Timing:
    """A frame from the usual place."""
    return _against_embree(car(), ROOF_LIDAR, "38 cm over a roof")


def rays_from_afar() -> Timing:
    """A frame from 20 m off."""
    return _against_embree(car(), (-22.0, 1.0, 1.2), "20 m off")


def rays_from_beside() -> Timing:
    """A frame from 5 m off."""
    return _against_embree(car(), BESIDE, "5 m off")


def rays_at_a_million_from_roof() -> Timing:
    """A frame from the usual place over a car of a million triangles and a half."""
    return _against_embree(car(1_500_000), ROOF_LIDAR, "38 cm over a roof")


def rays_at_a_million_from_beside() -> Timing:
    """The same from 5 m off, where most triangles are smaller than the gaps between rays."""
    return _against_embree(car(1_500_000), BESIDE, "5 m off")


def rays_at_many_triangles() -> Timing:
    """A frame from 3 cm over a car of millions of triangles."""
    return _against_embree(car(6_000_000), (-0.4, 0.02, 1.48), "3 cm over a roof")


def _against_embree(vehicle: pe.Vehicle, position: Position, label: str) -> Timing:
    _, directions, _ = rays_of(vehicle)
    vehicle.seen_from(position)  # builds the tree
    embree = Embree.of(vehicle.triangles)
    work = f"first hit of a frame, {len(vehicle.triangles):,} triangles, {label}"
    return _with_embree(
        work,
        embree,
        lambda: vehicle.first_hit(position, directions),
        position,
        directions=directions,
    )


def rays_of_a_camera() -> Timing:
    """A grazing camera on the grid, against embree on the rays to the voxels in its picture."""
    study = plain_study(None)
    vehicle = car(1_500)
    sensor = grazing_camera()
    rig = pe.Rig([sensor])
    evaluator = pe.Evaluator(study.space, study.prior, vehicle)
    directions = rays_to_voxels(sensor, study.space)
    work = (
        f"grid score, camera 5 cm over a roof ({len(directions) / 1e6:.0f} million voxels in view)"
    )
    embree = Embree.of(vehicle.triangles)
    position = sensor.pose.position
    return _with_embree(
        work, embree, lambda: evaluator.entropy(rig), position, directions=directions
    )


def _with_embree(
    work: str, embree: Embree | None, ours: Work, position: Position, directions: np.ndarray
) -> Timing:
    yardstick = "embree, one thread, the same rays"
    if embree is None:
        return Timing(work, best(ours)[0], peak_mb(), yardstick, yardstick_s=None)
    mine, theirs = best_in_turn(ours, lambda: embree.first_hit(position, directions))
    return Timing(work, mine, peak_mb(), yardstick, yardstick_s=theirs)


ROWS: dict[str, Callable[[], Timing]] = {
    row.__name__: row
    for row in (
        grid_free,
        grid_on_car,
        grid_two_lidars,
        grid_two_lidars_two_cameras,
        full_score,
        samples_free,
        samples_on_car,
        live_upright,
        live_tilted,
        live_camera,
        live_candidate,
        rays,
        rays_close,
        rays_from_roof,
        rays_from_afar,
        rays_from_beside,
        rays_at_a_million_from_roof,
        rays_at_a_million_from_beside,
        rays_at_many_triangles,
        rays_of_a_camera,
        live_map,
        fine_map,
        blind_ground,
        reach,
        nine_presets_preview,
        nine_presets,
        twelve_presets_with_shares_preview,
        four_states_in_three_weathers,
        simplify,
        request_of_a_move,
        answer_to_a_move,
        mesh_sent,
        candidate,
        candidates_in_processes,
        candidates_in_traffic,
        search_in_traffic,
        read_obj,
        read_ply,
        read_glb,
        full_score_of_four_lidars,
        full_score_of_many,
        time_against_sensors,
        objects_free,
        objects_on_car,
        objects_in_traffic,
        objects_of_a_rig,
        objects_of_a_camera,
    )
}

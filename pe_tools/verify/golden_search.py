"""Golden cases of verdicts and of searches."""

import hashlib
from collections.abc import Sequence
from itertools import permutations

import pe_core as pe
from pe_core.scoring.requirements import (
    BODIES,
    Criterion,
    Requirement,
    RequirementChecker,
    RobustTo,
    Zone,
)
from pe_core.study import study_from_dict, study_to_dict

from . import golden_scenes as scenes
from .golden_case import BY_HAND, ORACLE, STORED, GoldenCase

EVALUATIONS = 60
SAMPLES = 1024
SLOTS = ((1.5, 0.0, 1.9), (-1.5, 0.0, 1.9), (0.0, 0.8, 1.9), (0.0, -0.8, 1.9), (2.2, 0.0, 0.9))
PORTFOLIO_BITS = "073ea62a4690b9e3"
RANDOM_BITS = "32fc38d5b1833264"
"""Digests of two searches, of version 0.1.0."""
AHEAD = Zone(x=("front + 1", "front + 3"), y=(-1.0, 1.0), step=0.5)
BEHIND = Zone(x=("rear + 1", "rear + 3"), y=(-1.0, 1.0), step=0.5)


def verdict_cases() -> Sequence[GoldenCase]:
    """Return the cases of requirements, met and not met."""
    area = "verdicts"
    child = (BODIES["child"],)
    lost = RobustTo(one_lost=True)
    low = Criterion(blind_m2=3.9, blind_height=0.0)
    return (
        _hand(
            area,
            "a child ahead is seen",
            "nothing is between the camera at the front and the zone",
            [1, 1],
            found=lambda: _verdict(Requirement("ahead", AHEAD, child)),
        ),
        _hand(
            area,
            "a child behind is not seen",
            "the camera looks ahead: no sample passes",
            [0, 0],
            found=lambda: _verdict(Requirement("behind", BEHIND, child)),
        ),
        _hand(
            area,
            "not met with a sensor lost",
            "the only sensor is lost: no sample passes without it",
            [0, 0],
            found=lambda: _verdict(Requirement("lost", AHEAD, child, robust_to=lost)),
        ),
        _hand(
            area,
            "not met by two sensors",
            "there is one",
            [0, 0],
            found=lambda: _verdict(Requirement("two", AHEAD, child, Criterion(sensors=2))),
        ),
        _hand(
            area,
            "blind ground behind is all of the zone",
            "2 m by 2 m, 4 m2, more than 3.9",
            [0, 4.0],
            found=lambda: _blind(Requirement("ground", BEHIND, (), low)),
            tolerance=1e-6,
        ),
        _hand(
            area,
            "no blind ground ahead",
            "the camera is 1.2 m high and looks down by 25 deg: all of the zone is in its picture",
            [1, 0.0],
            found=lambda: _blind(Requirement("ground", AHEAD, (), low)),
            tolerance=1e-6,
        ),
    )


def search_cases() -> Sequence[GoldenCase]:
    """Return the cases of searches."""
    area = "search"
    bits = "all placements that were the best, one after the other, and their values"
    return (
        GoldenCase(
            "the best of all placements in slots",
            area,
            ORACLE,
            "two LiDARs in five slots: all 20 placements scored one by one",
            right=_counted_optimum,
            found=lambda: [_last_step(_in_slots(), "portfolio").value.objective],
            tolerance=0.0,
        ),
        GoldenCase(
            "a search finds what it says",
            area,
            ORACLE,
            "the value of the result is that of its rig, scored by another evaluator",
            right=lambda: [1.0],
            found=_value_is_of_rig,
        ),
        GoldenCase(
            "no placement in a no-go area",
            area,
            BY_HAND,
            "x < 0.5 is excluded: no best placement is there",
            right=[0.0],
            found=_inside_no_go,
        ),
        GoldenCase(
            "the same placements by the portfolio",
            area,
            STORED,
            bits,
            right=PORTFOLIO_BITS,
            found=lambda: _bits("portfolio"),
        ),
        GoldenCase(
            "the same placements by Algorithm 1",
            area,
            STORED,
            bits,
            right=RANDOM_BITS,
            found=lambda: _bits("random"),
        ),
        GoldenCase(
            "a study, written and read",
            area,
            BY_HAND,
            "the same score to the last bit",
            right=[0.0],
            found=_score_after_round_trip,
            tolerance=0.0,
        ),
    )


def _hand(
    area: str, name: str, about: str, right: Sequence[float], found: object, tolerance: float = 0.0
) -> GoldenCase:
    return GoldenCase(name, area, BY_HAND, about, right=right, found=found, tolerance=tolerance)  # type: ignore[arg-type]


def _checked(requirement: Requirement) -> pe.requirements.Verdict:
    camera = scenes.mounted(scenes.camera(130.0), (2.01, 0.0, 1.2), (0.0, 25.0, 0.0))
    space = pe.PerceptionSpace((-8.0, 8.0), (-6.0, 6.0), (0.0, 3.0), 0.1)
    checker = RequirementChecker([requirement], scenes.body(), space=space)
    (verdict,) = checker.check(pe.Rig([camera]))
    return verdict


def _verdict(requirement: Requirement) -> list[float]:
    """Return whether a requirement is met, and the share of samples that pass."""
    verdict = _checked(requirement)
    return [float(verdict.met), verdict.share]


def _blind(requirement: Requirement) -> list[float]:
    """Return whether a requirement is met, and the blind ground [m2]."""
    verdict = _checked(requirement)
    return [float(verdict.met), -1.0 if verdict.blind_m2 is None else verdict.blind_m2]


def _evaluator() -> pe.Evaluator:
    return pe.Evaluator(scenes.SPACE, pe.Prior.uniform(), scenes.body(), samples=SAMPLES)


def _lidars() -> list[pe.Sensor]:
    models = (scenes.lidar((-30.0, -15.0, 0.0), 60), scenes.lidar((-20.0, -10.0, 10.0), 36))
    pairs = zip("ab", models, SLOTS, strict=False)
    return [pe.Sensor(name, model, pe.Pose(place)) for name, model, place in pairs]


def _in_slots() -> pe.SearchSpace:
    slots = [pe.Slot(f"slot {k}", pe.Pose(place)) for k, place in enumerate(SLOTS)]
    mounting = pe.Mounting(mounts={"rack": pe.SlotMount(slots)}, on={"a": "rack", "b": "rack"})
    return pe.SearchSpace.on_vehicle(pe.Rig(_lidars()), scenes.body(), {}, mounting=mounting)


def _in_ranges() -> pe.SearchSpace:
    ranges = {"x": (-2.0, 2.0), "z": (1.7, 2.3), "pitch": (-0.3, 0.3)}
    no_go = pe.Mounting(constraints=pe.Constraints(no_go=[pe.NoGo("rear", x=(-9.0, 0.5))]))
    free = {name: tuple(ranges) for name in "ab"}
    return pe.SearchSpace.on_vehicle(
        _rig_in_ranges(), scenes.body(), free, dict.fromkeys("ab", ranges), mounting=no_go
    )


def _rig_in_ranges() -> pe.Rig:
    return pe.Rig([each.moved(pe.Pose((1.0, 0.3 * k, 1.9))) for k, each in enumerate(_lidars())])


def _steps(space: pe.SearchSpace, method: str) -> list[pe.Step]:
    rig = _rig_in_ranges() if space.bounds.get("a") else pe.Rig(_lidars())
    schedule = pe.Schedule(candidates=EVALUATIONS // 7) if method == "random" else None
    steps = pe.optimize(
        _evaluator(), rig, space, 3, schedule=schedule, method=method, evaluations=EVALUATIONS
    )
    return list(steps)


def _last_step(space: pe.SearchSpace, method: str) -> pe.Step:
    return _steps(space, method)[-1]


def _counted_optimum() -> list[float]:
    evaluator = _evaluator()
    rig = pe.Rig(_lidars())
    rigs = (rig.with_poses([pe.Pose(a), pe.Pose(b)]) for a, b in permutations(SLOTS, 2))
    return [min(evaluator.entropy(each) for each in rigs)]


def _value_is_of_rig() -> list[float]:
    last = _last_step(_in_ranges(), "portfolio")
    return [float(_evaluator().entropy(last.best) == last.value.objective)]


def _inside_no_go() -> list[float]:
    bests = {step.best for step in _steps(_in_ranges(), "portfolio") if step.improved}
    return [float(sum(each.pose.position[0] < 0.5 for best in bests for each in best))]


def _bits(method: str) -> str:
    """Return a digest of the placements that were the best, and of their values."""
    steps = [step for step in _steps(_in_ranges(), method) if step.improved]
    rows = [
        (step.evaluations, repr(step.value.objective), [repr(each.pose) for each in step.best])
        for step in steps
    ]
    return hashlib.sha256(repr(rows).encode()).hexdigest()[:16]


def _score_after_round_trip() -> list[float]:
    study = pe.Study(scenes.rig(), None, scenes.SPACE, prior=pe.Prior.uniform(), samples=SAMPLES)
    again = study_from_dict(study_to_dict(study))
    pair = [each.evaluator().score(each.rig).entropy for each in (study, again)]
    return [pair[1] - pair[0]]

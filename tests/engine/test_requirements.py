"""Verdicts: blind ground, margins, losses, previews, and mounting errors."""

import json
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring.requirements import (
    BODIES,
    Criterion,
    Reason,
    Requirement,
    RequirementChecker,
    RobustTo,
    Samples,
    VerdictSummary,
    Zone,
    margin_of,
    zone_growth,
)
from pe_core.scoring.requirements.body_checks import BodyChecks, SceneCaches
from pe_core.scoring.sight import Sight
from pe_core.search import Tolerance, mounted_off
from pe_tools.wording import margin_text, reason_text, unseen_text, verdict_text
from tests.engine.requirement_scene import AHEAD, MIDDLE, check, rig, van

GROWN = {
    "one": {},
    "two": {"criterion": Criterion(sensors=2)},
    "most": {"criterion": Criterion(kinds=2, zone_share=0.8)},
    "cameras": {"criterion": Criterion(of=("camera",), zone_share=0.95)},
    "in part": {"criterion": Criterion(share=0.3, zone_share=0.9)},
    "one lost": {"robust_to": RobustTo(one_lost=True)},
    "mounted off": {"robust_to": RobustTo(mounting=True), "criterion": Criterion(zone_share=0.97)},
    "by AP": {"criterion": Criterion(ap=0.5)},
}
SLOW = pytest.param("in part", marks=pytest.mark.thorough)
WHICH_GROW = [SLOW if name == "in part" else name for name in GROWN]


def test_blind_ground_of_a_zone_is_that_of_sight():
    """The squares in the zone, of `Sight.blind` on the same grid; a lost sensor blinds more."""
    zone = Zone(x=("front", "front + 2"), y=(-1, 1))
    own = Requirement(
        "ground",
        zone,
        bodies=(),
        criterion=Criterion(blind_m2=1.0, blind_height=0.4),
        robust_to=RobustTo(True),
    )
    space = pe.PerceptionSpace((-10, 10), (-8, 8), (0, 3), 0.1)
    (verdict,) = RequirementChecker([own], van(), space=space).check(rig())
    whole = Sight(space, pe.Prior.uniform(), van()).blind(rig(), 0.4, within=4.0)
    assert 0.0 < verdict.blind_m2 <= whole.area + 0.01
    assert verdict.met is (verdict.blind_m2 <= 1.0 and all(verdict.without.values()))
    (tight,) = RequirementChecker(
        [replace(own, criterion=Criterion(max_blind_distance=0.0, blind_height=0.4))],
        van(),
        space=space,
    ).check(rig())
    assert not tight.met


def test_blind_ground_is_searched_in_all_of_a_zone_with_voxels_of_any_size():
    """Columns of voxels that are only in part in the zone count: else edges would not be searched,
    nor a zone without a whole one."""
    for zone in (Zone(x=(-1.42, 2.78), y=(1.17, 3.48)), Zone(x=(-0.3, 0.2), y=(1.7, 2.2))):
        own = Requirement("ground", zone, (), Criterion(blind_m2=0.0, blind_height=0.5))
        spaces = (pe.PerceptionSpace((-6, 6), (-4, 4), (0, 3), side) for side in (0.05, 0.5))
        fine, coarse = (RequirementChecker([own], van(), space=space) for space in spaces)
        assert fine.check(rig())[0].blind_m2 == coarse.check(rig())[0].blind_m2 > 0.0


def test_blind_ground_counts_the_kinds_that_are_asked_for():
    """`of` is of ground, too; a radar sees neither flat ground nor what is lower than a child."""
    zone = Zone(x=("front + 1", "front + 4"), y=(-1, 1))
    space = pe.PerceptionSpace((-9, 9), (-6, 6))
    radar = pe.Sensor("radar", pe.catalog.load("Continental ARS408-21"), pe.Pose((2.55, 0, 0.6)))
    whole = pe.Rig([*rig(), radar])

    def blind(rig, height=0.8, **asked):
        own = Requirement("g", zone, (), Criterion(blind_m2=0.1, blind_height=height, **asked))
        return RequirementChecker([own], van(), space=space).check(rig)[0].blind_m2

    cameras = pe.Rig([s for s in rig() if s.kind == "camera"])
    for height in (0.0, 0.4, 0.8):
        assert blind(whole, height, of=("camera",)) == blind(cameras, height)
    alone = pe.Rig([radar])
    assert blind(alone) < 0.1
    for height in (0.0, 0.4):
        with pytest.raises(pe.InputError, match="blind_height"):
            blind(alone, height)


def test_blind_ground_with_the_only_sensor_lost_is_all_of_it():
    """As of bodies; with two sensors the one that is left counts."""
    zone = Zone(x=("front + 1", "front + 3"), y=(-1, 1))
    space = pe.PerceptionSpace((-9, 9), (-6, 6))
    for under in (RobustTo(), RobustTo(one_lost=True)):
        own = Requirement(
            "g",
            zone,
            bodies=(),
            criterion=Criterion(blind_m2=0.5, blind_height=0.8),
            robust_to=under,
        )
        checker = RequirementChecker([own], van(), space=space)
        (found,) = checker.check(pe.Rig([rig()["front"]]))
        assert found.met_whole and found.breaks_without == ("front",)
        assert found.met is not under.one_lost
        assert (checker.shortfalls(pe.Rig([rig()["front"]]))[0] == 0.0) is found.met


def test_ap_is_fused_from_the_kinds_that_are_asked_for():
    """A camera that sees the body well lends nothing to a criterion of LiDARs."""
    lidars = pe.Rig([rig()["top"]])
    for ap in (0.2, 0.4):
        own = Requirement("ap", AHEAD, (BODIES["child"],), Criterion(ap=ap, of=("lidar",)))
        assert check(own)[0].passed.tolist() == check(own, of=lidars)[0].passed.tolist()


def test_margins_of_blind_ground_are_those_of_its_squares():
    """The limits' spare is what is left of them; a ring that is grown by the margin is met."""
    space = pe.PerceptionSpace((-12, 12), (-10, 10), (0, 3), 0.1)
    zone = Zone(x=("front + 1", "front + 1.5"), y=(-0.5, 0.5))
    criterion = Criterion(blind_m2=0.2, blind_height=0.8)

    def verdict(own, **asked):
        own = Requirement("ground", own, (), replace(criterion, **asked))
        return RequirementChecker([own], van(), space=space).check(rig())[0]

    found = verdict(zone)
    assert found.met and found.margin > 0.0 and not found.at_least
    assert found.ground.spare_m2 == pytest.approx(0.2 - found.blind_m2, abs=0.011)
    by = found.margin
    low = f"front + {max(1.0 - by, 0.0):.6f}"
    high = f"front + {1.5 + by:.6f}"
    larger = replace(zone, x=(low, high), y=(-0.5 - by, 0.5 + by))
    assert verdict(larger).met
    beside = verdict(replace(zone, x=(-2.0, 2.0), y=("left + 0.2", "left + 2")))
    assert not beside.met and beside.margin < 0.0 and beside.ground.spare_m2 < 0.0
    inner = verdict(replace(zone, x=(-2.0, 2.0), y=("left + 0.2", "left + 2")), blind_m2=1e3)
    assert inner.met and inner.summary.blind_m2 is not None
    out = verdict(zone, blind_m2=None, max_blind_distance=0.0)
    assert out.ground.spare_out == pytest.approx(-out.ground.blind_distance, abs=0.011)


def test_losses_hidden_parts_and_the_worst_place_are_named():
    behind = Requirement(
        "behind", Zone(x=("rear + 0.4", "rear + 1.6"), y=(-0.6, 0.6)), (BODIES["adult"],)
    )
    (found,) = check(behind)
    assert found.met and found.breaks_without == ("rear",)
    assert found.without == {"top": True, "front": True, "rear": False}
    alone = pe.Rig([rig()["top"], rig()["front"]])
    (lost,) = check(behind, of=alone)
    assert not lost.met and lost.margin < 0.0 and lost.worst is not None
    assert set(lost.unseen_by) == {"top", "front"}
    assert Reason("occluded", "body") in lost.unseen_by.values()
    told = [part.removesuffix(")").split(" (") for part in unseen_text(lost.unseen_by).split("; ")]
    texts = {name: text for text, names in told for name in names.split(", ")}
    assert texts == {name: reason_text(reason) for name, reason in lost.unseen_by.items()}
    assert lost.row.summary.worst == lost.worst


def test_mounting_errors_count_where_they_are_asked_for():
    """A case that sees nothing breaks the requirement under mounting errors, and that one alone."""
    own = Requirement("as built", MIDDLE, (BODIES["child"],))
    robust = replace(own, name="off", robust_to=RobustTo(mounting=True))
    blind = pe.Rig([replace(s, pose=pe.Pose((0.0, 0.0, 1.0))) for s in rig()])  # inside the body
    as_built, off = check(own, robust, cases=[blind])
    assert as_built.met and not off.met and off.met_whole


@pytest.mark.parametrize("name", WHICH_GROW)
def test_margins_are_those_of_all_sensors_on_all_the_ground_round_a_zone(name, monkeypatch):
    """By the plain definition; asked again, after a sensor moved, and part by part as well."""
    zone = Zone(x=("front + 3", "front + 3.6"), y=(-0.3, 0.3), step=0.3)
    own = Requirement(name, zone, (BODIES["adult"],), **GROWN[name])
    checker = RequirementChecker([own], van())
    monkeypatch.setattr(zone_growth, "PART_BOXES", 60)
    top = pe.Pose((2.2, -0.3, 2.6), (0.0, 0.2, 0.1))
    moved = rig().with_poses([top, *(sensor.pose for sensor in list(rig())[1:])])
    margins = set()
    for one in (rig(), moved, rig()):
        cases = mounted_off(one, Tolerance(position=0.1, angle=0.02), 3)[:2]
        (verdict,) = checker.check(one, cases=cases)
        assert (verdict.margin, verdict.at_least) == _plain_margin(own, one, cases)
        margins.add(verdict.margin)
    assert max(margins) > 0.0


def test_all_verdicts_come_before_the_first_margin_and_stay():
    """Early ones are those of the check, but for how far a zone could grow."""
    zone = Zone(x=("front + 3", "front + 3.6"), y=(-0.3, 0.3), step=0.3)
    wanted = [
        Requirement(name, zone, (BODIES["adult"],), **GROWN[name])
        for name in ("one", "two", "most")
    ]
    wanted.insert(1, Requirement("ground", MIDDLE, criterion=Criterion(blind_m2=1.0)))
    checker = RequirementChecker(wanted, van())
    steps = list(checker.steps(rig(), early=True))
    found = [step for step in steps if step.verdict is not None]
    early = [step.verdict for step in found if step.is_early]
    last = [step.verdict for step in found if not step.is_early]
    assert [step.is_early for step in found] == [True] * 4 + [False] * 4
    assert [each.name for each in early] == ["one", "ground", "two", "most"]
    expected = checker.check(rig())
    assert [each.summary for each in last] == [each.summary for each in expected]
    by_name = {each.name: each for each in last}
    for each in early:
        assert each.met == by_name[each.name].met
        assert each.margin == by_name[each.name].margin or each.at_least
        assert each.margin is None or each.margin <= by_name[each.name].margin
    assert any(each.margin < by_name[each.name].margin for each in early)
    with_margins = [step.fraction for step in steps]
    assert with_margins == sorted(with_margins) and with_margins[-1] == 1.0


def _plain_margin(own, one, cases):
    """`margin_of` all samples of rings that are grown as far as the zone does not fail."""
    placed = own.zone.placed(van(), None, own.name)
    points, distance = placed.samples()
    looked = placed.grow
    passed = None
    while True:
        checks = BodyChecks(
            [(own, Samples(placed, points, distance))], pe.PerceptionModel(), SceneCaches(van())
        )
        passed = checks.results(one, cases)[0].passed
        margin = margin_of(distance, passed, own.criterion.zone_share, own.zone.step, looked=looked)
        if not margin[1] or looked >= 10.0:
            return margin
        wider = min(2.0 * looked, 10.0)
        ring, away = placed.ring_of_samples(looked, wider, 30_000)
        points = np.concatenate([points, ring])
        distance = np.concatenate([distance, away])
        looked = wider


def test_texts_come_from_values_that_survive_json():
    def texts(**values):
        plain = {"name": "ahead", "check": "", "met": True, "margin_m": None, "share": 0.5}
        plain |= {"margin_at_least": False, "samples": 4000, "failing": 2000, "blind_m2": None}
        plain |= {"condition": "", "preview": False, "worst": None, **values}
        summary = VerdictSummary(**json.loads(json.dumps(plain)))
        return margin_text(summary), verdict_text(summary)

    assert texts(preview=True) == ("", "ahead: met (preview)")
    assert texts(margin_m=0.5) == ("0.50 m", "ahead: met, margin 0.50 m")
    found = texts(margin_m=0.3, margin_at_least=True, blind_m2=0.4, condition="rain", check="R159")
    checked = "geometric check after R159: met, blind 0.40 m2, margin at least 0.30 m, in rain"
    assert found == ("blind 0.40 m2, at least 0.30 m", checked)
    assert texts(met=False, margin_m=-0.15)[0] == "fails in the outer 0.15 m"
    assert texts(met=False)[0] == "fails at 2,000 of 4,000 places"

"""Who watches a grid score is told how far it is, and can end it."""

import threading

import pytest

import pe_core as pe
from pe_core.scoring import ScoreStopped
from tests.engine import shapes
from tests.limits import HANG_S

SPACE = pe.PerceptionSpace((-40, 40), (-10, 10), (0, 4), 0.5)  # five blocks of 32 planes


def evaluator(samples=0):
    return pe.Evaluator(SPACE, pe.Prior.road(), shapes.box_car(), samples=samples)


def rig():
    return pe.Rig([shapes.lidar_on_roof(), shapes.camera()])


def test_the_share_rises_to_the_whole_and_changes_no_score():
    told = []
    score = evaluator().score(rig(), watch=lambda share: told.append(share) or True)
    assert told == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    assert score.to_dict() == evaluator().score(rig()).to_dict()


def test_a_sample_tells_its_share_after_each_sensor_and_ends_when_asked():
    """Thousands of sensors take hours: how long is known after the first few."""
    told, some = [], evaluator(4096)
    score = some.score(rig(), watch=lambda share: told.append(share) or True)
    assert len(told) == 5 and told == sorted(told) and told[0] == 0.0
    assert told[-1] == pytest.approx(1.0)
    moved = pe.Rig([sensor.moved(pe.Pose((0.2, 0.0, 1.9))) for sensor in rig()])
    for calls in (1, 2, 4):
        left = iter([True] * calls)
        with pytest.raises(ScoreStopped):
            some.score(moved, watch=lambda _, left=left: next(left, False))
    assert some.score(rig()).to_dict() == score.to_dict()
    assert some.score(moved).to_dict() == evaluator(4096).score(moved).to_dict()


@pytest.mark.parametrize("at", [0.0, 0.4, 1.0])
def test_a_score_ends_when_it_is_reported_and_the_next_is_sound(at):
    own = evaluator()
    told = []

    def watch(share):
        told.append(share)
        return share < at

    with pytest.raises(ScoreStopped):
        own.score(rig(), watch=watch)
    assert told[-1] == pytest.approx(at) and told == sorted(told)
    assert own.score(rig()).to_dict() == evaluator().score(rig()).to_dict()


def test_a_stopped_job_s_thread_stops_as_well(monkeypatch):
    """Its score is given up, and does not run on behind the program's back."""
    started, go, done = threading.Event(), threading.Event(), threading.Event()
    ended, whole = [], pe.Evaluator.score

    def score(self, *args, **kwargs):
        started.set()
        go.wait(HANG_S)
        try:
            ended.append(whole(self, *args, **kwargs))
        except ScoreStopped:
            ended.append("stopped")
            raise
        finally:
            done.set()

    monkeypatch.setattr(pe.Evaluator, "score", score)
    job = pe.ScoreJob(pe.Study(rig(), shapes.box_car(), SPACE))
    steps = iter(job)
    next(steps)
    next(steps)
    assert started.wait(HANG_S)
    job.stop()
    assert not list(steps) and job.outcome is None
    go.set()
    assert done.wait(HANG_S) and ended == ["stopped"]

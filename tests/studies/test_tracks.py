"""Real tracks: moments by hand, which tracks count, persistence, saved conclusions."""

import json
from pathlib import Path

import numpy as np
import pytest

from pe_core.metric.entropy import BLIND_PRECISION
from pe_core.motion import CORRELATION_TIME_S, Confirmation
from pe_core.scene.objects import Objects
from studies.pages import PAGE
from studies.road.logs import CLASSES, Log
from studies.road.statistics import HOLDS, OPEN, REFUTED
from studies.tracks import __main__ as study
from studies.tracks import order
from studies.tracks.memory import LAGS, NEAR, fitted, memory_statements, pairs_of_class
from studies.tracks.memory import measured as correlation_of
from studies.tracks.moments import Moments, compared, pairs_of, persistence, tracks_of, verdict

FOLDER = Path(__file__).parents[2] / "docs/validity/tracks"


def seen(text):
    return np.array([letter == "x" for letter in text])


@pytest.mark.parametrize(
    ("text", "first", "confirmed", "lost"),
    [
        (".....", None, None, 0.0),
        ("..x..x...", 2, None, 0.0),
        ("..x.xx...", 2, 5, 0.0),
        ("xxx....x", 0, 2, 0.4),
        ("..xxx.x...xx", 2, 4, 0.3),
    ],
)
def test_moments_by_hand(text, first, confirmed, lost):
    found = Moments.of(seen(text))
    assert (found.first, found.confirmed) == (first, confirmed)
    assert found.lost_s == pytest.approx(lost)


def log_of(rows):
    """Return a log of boxes (frame, track, x, points)."""
    frames, tracks, x, points = np.array(rows).T
    count = len(rows)
    centers = np.column_stack([x, np.zeros(count), np.ones(count)])
    sizes = np.tile([4.0, 2.0, 1.5], (count, 1))
    boxes = Objects(
        centers, sizes, np.zeros(count), [0] * count, class_names=CLASSES, scenes=frames.astype(int)
    )
    return Log("a log", boxes, points.astype(int), tracks.astype(int))


def test_a_track_that_is_seen_at_once_does_not_count():
    late = [(k, 0, 40.0 - k, 9 * (k > 6)) for k in range(20)]
    at_once = [(k, 1, 20.0, 30) for k in range(20)]
    gap = [(k, 2, 30.0, 0) for k in range(20) if k != 10]
    log = log_of(late + at_once + gap)
    assert sorted(map(len, tracks_of(log))) == [9, 10, 20, 20]
    m = np.where(log.tracks == 1, 30.0, np.where(log.objects.scenes > 9, 8.0, 0.0))
    pairs = [p for p in pairs_of(log, m, 5) if p.real.confirmed is not None]
    assert [(p.name, p.ring, p.late("first"), p.late("confirmed")) for p in pairs] == [
        ("car", 2, pytest.approx(0.3), pytest.approx(0.3))
    ]


def test_figures_of_many_tracks():
    rows = [(k, t, 40.0, 9 * (k > 6)) for t in range(12) for k in range(30)]
    log = log_of(rows)
    m = np.where((log.objects.scenes > 7 + log.tracks % 3) & (log.tracks < 11), 9.0, 0.0)
    cell = compared(pairs_of(log, m, 5))
    assert (cell["tracks"], cell["both"]) == (12, 11)
    assert cell["confirmed_s"][0] == pytest.approx(0.2) and cell["near"][0] == 1.0
    assert cell["missed"][0] == pytest.approx(1 / 12, abs=1e-3) and cell["invented"][0] == 0.0


def test_persistence_is_that_of_the_chain():
    rng = np.random.default_rng(3)
    p = 0.4
    r = 0.6
    rows = []
    for track in range(40):
        hit = rng.random() < p
        for k in range(100):
            hit = rng.random() < (p + r * (1 - p) if hit else p * (1 - r))
            rows.append((k, track, 40.0, 9 * hit))
    found = persistence(log_of(rows), np.ones(len(rows)), 5)["car"]
    assert found["correlation"] == pytest.approx(r, abs=0.06)


def test_verdicts_follow_the_interval():
    assert verdict([0.0, -0.1, 0.1], -0.5, 0.5) == HOLDS
    assert verdict([0.9, 0.6, 1.1], -0.5, 0.5) == REFUTED
    assert verdict([0.4, 0.2, 0.6], -0.5, 0.5) == verdict(None, -0.5, 0.5) == OPEN


def test_published_order_follows_from_the_equations():
    assert all(order.follows().values())
    one = np.array([0.3, 0.6, 0.9])
    assert order.over_frames(one, 1, 1.0) == pytest.approx(one)
    twice = 2.0 / (1.0 / one - 1.0) ** 2 - BLIND_PRECISION  # two frames without noise
    assert order.over_frames(one, 2, 0.0) == pytest.approx(1.0 / (1.0 + twice**-0.5))
    verdicts = [row[-1] for row in order.statements()]
    assert verdicts == [order.HOLDS, order.FAILS, order.HOLDS, order.HOLDS, order.FAILS]


def test_the_page_is_that_of_the_saved_figures():
    found = json.loads((FOLDER / "results.json").read_text())
    assert (FOLDER / PAGE).read_text() == study.page_of(found)
    whole = found["memory"]["5"]["thirds"]["all"]
    assert round(2.0 * whole["time_s"]) / 2.0 == CORRELATION_TIME_S  # the plan's rule
    for lag, (_, low, high) in zip(LAGS, whole["correlation"], strict=True):
        both = Confirmation(2).kept([0.5, 0.5], lag * 0.1, window=2)[-1]
        assert low - NEAR < (both - 0.25) / 0.25 < high + NEAR


def test_a_correlation_time_is_found_again():
    rng = np.random.default_rng(5)
    time_s = 1.5
    rows = []
    kept = np.exp(-0.1 / time_s)
    for track in range(60):
        z = rng.standard_normal()
        for k in range(120):
            z = kept * z + np.sqrt(1.0 - kept * kept) * rng.standard_normal()
            rows.append((k, track, 40.0, 9 * (z < 0.2)))
    log = log_of(rows)
    cells = {
        lag: [pairs_of_class(log, np.ones(len(rows)), "car", lag, n=5, groups=3)] for lag in LAGS
    }
    assert fitted(cells)["time_s"] == pytest.approx(time_s, abs=0.4)


def test_pairs_of_frames_by_hand():
    # one track: seen, seen, not, seen; two frames apart: (1, 0), (1, 1)
    log = log_of([(k, 0, 40.0, n) for k, n in enumerate((9, 9, 0, 9))])
    pairs = pairs_of_class(log, np.ones(4), "car", lag=2, n=5, groups=1)
    counts = [float(t.sum()) for t in (pairs.all, pairs.first, pairs.then, pairs.both)]
    assert counts == [2.0, 2.0, 1.0, 1.0]
    assert (
        pairs_of_class(log, np.ones(4), "car", lag=4, n=5, groups=1).total == 0.0
    )  # no pair so far apart
    assert correlation_of([pairs]) == 0.0  # P(seen | seen) = P(seen) = 1/2


def test_what_the_plan_says_of_the_memory():
    def found(values, model):
        return {"thirds": {"all": {"correlation": [[v, v, v] for v in values], "model": model}}}

    slow = [0.8, 0.7, 0.65, 0.55, 0.4, 0.3]
    chain = [0.8, 0.64, 0.51, 0.33, 0.11, 0.01]
    said = [row[-1] for row in memory_statements(found(slow, slow))]
    assert said == ["holds", "holds"]
    said = [row[-1] for row in memory_statements(found(chain, slow))]
    assert said == ["does not hold", "does not hold"]

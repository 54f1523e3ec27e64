"""What the live read-out says, word by word."""

from dataclasses import replace

import pytest

from blender_addon.engine import advice, pe, sight
from blender_addon.live import readout, readout_text, state
from blender_addon.live.readout_text import BETTER, SAME, WORSE
from blender_addon.live.state import Baseline, ShownFigures, ShownScore
from pe_core.scoring.score import TrafficAp


def summary(entropy=3.0, coverage=0.85, zones=()):
    per_zone = {name: pe.PartScore(h, c, 0.5) for name, h, c in zones}
    return pe.SummaryScore(entropy, coverage, 0.0224, {}, per_zone, 32768)


def said(now, before=None, rested=True):
    return readout_text.readout_of(reading_of(now, before), score_of(now, rested))


def score_of(now, exact=True, stored=False):
    return ShownScore(now.entropy, now.coverage, now.stderr, exact, stored)


def reading_of(now, before=None, label="before this move"):
    reference = None if before is None else Baseline(label, None, before)
    return state.LiveScore(now, reference, True, None)


def test_a_score_on_objects_has_its_expected_ap_beside_it():
    now, before = (replace(summary(), voxels=0, ap=ap) for ap in (0.653, 0.641))
    lines = map(readout_text.text_of, said(now).lines)
    assert list(lines) == ["Objects visible: 85.0%", "Expected AP 0.653"]
    assert said(now, before).lines[1] == (("Expected AP 0.653", SAME), ("(+0.012)", BETTER))


@pytest.mark.parametrize(
    ("told", "line"),
    [
        ({"stored": True}, "± 0.022  as scored"),
        ({"stored": True, "stderr": 0.0}, "on all voxels, as scored"),
        ({"view_outdated": True}, "± 0.022  exact, beams and maps follow"),
        ({"state": "door open"}, "± 0.022  exact, state door open"),
    ],
)
def test_what_a_score_is_of_is_said(told, line):
    assert readout_text.state_of(score_of(summary())._replace(**told)) == line


def test_coverage_changes_in_points():
    assert said(summary(), summary(coverage=0.838)).lines[0] == (
        ("Coverage 85.0%", SAME),
        ("(+1.2)", BETTER),
    )
    assert said(summary(), summary(coverage=0.862)).lines[0] == (
        ("Coverage 85.0%", SAME),
        ("(\N{MINUS SIGN}1.2)", WORSE),
    )
    assert said(summary(), summary(coverage=0.8502)).lines[0] == (("Coverage 85.0%", SAME),)


def test_the_zones_that_changed_most_are_named():
    before = summary(zones=[("front", 3.0, 0.9), ("left", 2.0, 0.8), ("far", 5.0, 0.7)])
    now = summary(zones=[("front", 2.8, 0.94), ("left", 2.3, 0.72), ("far", 4.99, 0.7)])
    assert said(now, before).lines[1:] == (
        (("Better ahead by 0.20 nats", BETTER),),
        (("Worse on the left by 0.30 nats", WORSE),),
    )
    assert said(before, before).lines[1:] == ()


def test_the_read_out_says_what_is_in_the_way_below_what_was():
    reading = reading_of(summary())
    line = "scene: sensor 'roof': scale: expected 1 in each direction, found 2, 2, 2"
    found = readout.rows_of(reading, line, score_of(summary()))
    rows = [text for each in found for text, color in each.words if color == readout.ALERT]
    assert " ".join(rows) == line and all(len(row) <= readout.MAX_COLUMNS for row in rows)
    assert found[0].words[0][0] == "3.000 nats"
    assert readout.rows_of(None, "", None)[0].words[0][0] == "Live: scoring ..."


def test_better_and_worse_differ_by_arrow_and_colour():
    lines = [
        readout.rows_of(reading_of(summary(), summary(h)), "", score_of(summary()))[0].words[1]
        for h in (3.1, 2.9)
    ]
    (better, blue), (worse, orange) = lines
    assert better.startswith("\N{DOWNWARDS ARROW}") and worse.startswith("\N{UPWARDS ARROW}")
    assert blue[2] > blue[0] and orange[0] > orange[2]


TRAFFIC = "AP in traffic 0.617 near 0.90"
FOUND = "Pedestrian detected to 47 m ahead"
SECTOR = "Widest blind sector 12.1 deg to what is 0.5 m tall, 1 m: none"


def figures(**changed):
    told = {"blind_m2": 81.24, "height": 0.5, "within": 10.0, "class_name": "pedestrian"}
    told |= {"reach_m": 47.2, "at_least": False}
    told["traffic"] = TrafficAp(changed.pop("ap", 0.617), 0.005, 256, {"near": (0.9, 0.01)})
    widths = changed.pop("widths", (12.01, 0.0))
    told["sectors"] = tuple(map(sight.BlindSector, (0.5, 1.0), widths, (0.0, 0.0)))
    return advice.KeyFigures(**told | changed)


def texts(shown):
    return tuple(map(readout_text.text_of, readout_text.figure_lines(shown)))


def test_each_gain_and_each_loss_of_the_figures_has_its_colour():
    """More blind ground is a loss, however much farther objects are detected."""
    before = figures(blind_m2=24.0, reach_m=45.0, ap=0.7, widths=(13.0, 0.0))
    shown = ShownFigures(figures(blind_m2=53.0), before, True)
    traffic, sector, blind, reach = readout_text.figure_lines(shown)
    assert [piece.sense for piece in traffic] == [SAME, WORSE, SAME]
    assert [piece.sense for piece in sector] == [SAME, BETTER, SAME]
    assert [piece.sense for piece in blind] == [SAME, WORSE]
    assert [piece.sense for piece in reach] == [SAME, BETTER]
    rows = [readout.row_of(line) for line in (blind, reach)]
    assert rows[0].words[1][1] == readout.SENSE_COLORS[WORSE]
    assert rows[1].words[1][1] == readout.SENSE_COLORS[BETTER]
    assert readout_text.sense_of(blind) == WORSE and readout_text.sense_of(blind[:1]) == SAME


@pytest.mark.parametrize(
    ("now", "before", "lines"),
    [
        (figures(), None, (TRAFFIC, SECTOR, "81.2 m² blind to what is 0.5 m tall", FOUND)),
        (
            figures(),
            figures(blind_m2=84.3, reach_m=45.0, ap=0.6, widths=(14.0, 0.0)),
            (
                "AP in traffic 0.617 (+0.017) near 0.90",
                "Widest blind sector 12.1 deg (\N{MINUS SIGN}2.0) to what is 0.5 m tall, 1 m: none",
                "81.2 m² blind to what is 0.5 m tall (\N{MINUS SIGN}3.1)",
                "Pedestrian detected to 47 m ahead (+2)",
            ),
        ),
        (
            replace(figures(height=0.0, reach_m=80.0, at_least=True), traffic=None),
            figures(blind_m2=81.26, reach_m=80.0),
            (
                "",
                SECTOR,
                "81.2 m² blind to what lies flat",
                "Pedestrian detected to \N{GREATER-THAN OR EQUAL TO} 80 m ahead",
            ),
        ),
        (
            figures(reach_m=0.0, class_name="cone"),
            None,
            (TRAFFIC, SECTOR, "81.2 m² blind to what is 0.5 m tall", "Cone detected nowhere ahead"),
        ),
        (
            figures(reach_m=None, class_name=None),
            None,
            (TRAFFIC, SECTOR, "81.2 m² blind to what is 0.5 m tall", ""),
        ),
    ],
)
def test_figures_in_words(now, before, lines):
    assert texts(ShownFigures(now, before, True)) == lines
    of_before = tuple(f"Before this move: {line}" if line else "" for line in lines)
    assert before or texts(ShownFigures(now)) == of_before

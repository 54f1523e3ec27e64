"""What the live read-out says, word by word."""

from dataclasses import replace

from blender_addon.engine import advice, pe, sight
from blender_addon.live import readout, readout_text, state
from blender_addon.live.readout_text import BETTER, SAME, WORSE
from blender_addon.live.state import Baseline, ShownFigures, ShownScore
from pe_core.scoring.score import TrafficAp


def summary(entropy=3.0, coverage=0.85, zones=()):
    per_zone = {name: pe.PartScore(h, c, 0.5) for name, h, c in zones}
    return pe.Score(entropy, coverage, 0.0224, {}, per_zone, {}, 32768)


def score_of(now, exact=True, stored=False):
    return ShownScore(now.entropy, now.coverage, now.stderr, exact, stored)


def reading_of(now, before=None, label="before this move"):
    reference = None if before is None else Baseline(label, None, before)
    return state.LiveScore(now, reference, True, None)


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


def figures(**changed):
    told = {"blind_m2": 81.24, "height": 0.5, "within": 10.0, "class_name": "pedestrian"}
    told |= {"reach_m": 47.2, "at_least": False}
    told["traffic"] = TrafficAp(changed.pop("ap", 0.617), 0.005, 256, {"near": (0.9, 0.01)})
    widths = changed.pop("widths", (12.01, 0.0))
    told["sectors"] = tuple(map(sight.BlindSector, (0.5, 1.0), widths, (0.0, 0.0)))
    return advice.KeyFigures(**told | changed)


def rows(now, before=None):
    lines = readout_text.figure_lines(ShownFigures(now, before, True))
    return {name.text: (figure.text, figure.sense) for name, figure in lines}


def test_each_gain_and_each_loss_of_the_figures_has_its_colour():
    """More blind ground is a loss, however much farther objects are detected."""
    before = figures(blind_m2=24.0, reach_m=45.0, ap=0.7, widths=(14.0, 0.0))
    shown = ShownFigures(figures(blind_m2=53.0), before, True)
    lines = {line[0].text: line for line in readout_text.figure_lines(shown)}
    assert [line[1].sense for line in lines.values()] == [WORSE, SAME, BETTER, WORSE, BETTER]
    drawn = [readout.row_of(lines[name]) for name in ("Blind Ground", "Reach Ahead")]
    assert drawn[0].words[1][1] == readout.SENSE_COLORS[WORSE]
    assert drawn[1].words[1][1] == readout.SENSE_COLORS[BETTER]


def test_figures_in_words():
    assert rows(figures()) == {
        "AP in Traffic": ("0.617 ± 0.005", SAME),
        "Near": ("0.90", SAME),
        "Blind Sector": ("12.1 deg (0.5 m tall)", SAME),
        "Blind Ground": ("81.3 m²", SAME),
        "Reach Ahead": ("47 m (pedestrian)", SAME),
    }
    before = figures(blind_m2=84.3, reach_m=45.0, ap=0.6, widths=(14.0, 0.0))
    told = rows(figures(), before)
    assert told["Reach Ahead"] == ("45 m \N{RIGHTWARDS ARROW} 47 m (pedestrian)", BETTER)
    assert told["Blind Sector"][0] == "14.0 deg \N{RIGHTWARDS ARROW} 12.1 deg"
    told = rows(replace(figures(reach_m=80.0, at_least=True), traffic=None))
    assert told["AP in Traffic"][0] == readout_text.NO_FIGURE
    assert told["Reach Ahead"][0] == "≥ 80 m (pedestrian)"
    assert rows(figures(reach_m=None, class_name=None))["Reach Ahead"][0] == readout_text.NO_FIGURE
    pending = readout_text.figure_lines(ShownFigures())
    assert pending == ((readout_text.TextPiece(readout_text.PENDING),),)

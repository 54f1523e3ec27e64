"""What the live read-out says, word by word."""

from dataclasses import replace

from blender_addon.engine import advice, pe, search, sight
from blender_addon.live import readout, readout_text, state
from blender_addon.live.readout_text import BETTER, SAME, WORSE
from blender_addon.live.state import Baseline, ShownScore
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


def figures(**changed):
    told = {"blind_m2": 81.24, "height": 0.5, "within": 10.0}
    told["reach"] = {"car": (62.4, True), "pedestrian": (changed.pop("reach_m", 47.2), False)}
    told["traffic"] = TrafficAp(changed.pop("ap", 0.617), 0.005, 256, {"near": (0.9, 0.01)})
    widths = changed.pop("widths", (12.01, 0.0))
    told["sectors"] = tuple(map(sight.BlindSector, (0.5, 1.0), widths, (0.0, 0.0)))
    return advice.KeyFigures(**told | changed)


def rows(*found):
    """Text and sense of each key figure, of one rig or of before and now."""
    told = {}
    for figure in search.KEY_FIGURES.values():
        if figure.part:
            values = [v for each in found if (v := figure.value(each)) is not None]
            told[figure.label] = readout_text.change_text(figure, values)
    return told


def test_each_gain_and_each_loss_of_the_figures_is_told():
    """More blind ground is a loss, however much farther objects are detected."""
    before = figures(blind_m2=24.0, reach_m=45.0, ap=0.7, widths=(14.0, 0.0))
    found = rows(before, figures(blind_m2=53.0))
    senses = {name: sense for name, (_, sense) in found.items() if sense != SAME}
    gains, losses = ("Blind sector", "Reach"), ("Blind ground", "AP in traffic")
    assert senses == dict.fromkeys(gains, BETTER) | dict.fromkeys(losses, WORSE)


def test_figures_in_words():
    none = (readout_text.NO_FIGURE, SAME)
    assert rows(figures()) == {
        "Blind ground": ("81.3 m²", SAME),
        "Blind sector": ("12.1 deg", SAME),
        "Reach": ("47 m", SAME),
        "AP near": ("0.90", SAME),
        "AP middle": none,
        "AP far": none,
        "AP in traffic": ("0.617", SAME),
    }
    told = rows(figures(blind_m2=84.3, reach_m=45.0, ap=0.6, widths=(14.0, 0.0)), figures())
    assert told["Reach"] == ("45 \N{RIGHTWARDS ARROW} 47 m", BETTER)
    assert told["Blind sector"][0] == "14.0 \N{RIGHTWARDS ARROW} 12.1 deg"
    assert rows(replace(figures(), traffic=None))["AP in traffic"] == none
    assert rows(figures(reach={}))["Reach"] == none

"""The page's verdicts follow from the figures: whoever turns the figures over turns the words."""

import ast
import copy
import json
import math
import re

import pytest

from pe_report.claims import TEXTS, claims
from pe_report.facts import Facts
from pe_report.page import page
from pe_report.paper import ROW
from pe_report.places import printed
from tests.report.conftest import ROOT

DOCS = ROOT / "docs" / "reproduction"
COMMITTED = json.loads((DOCS / "results.json").read_text("utf-8"))
PRIORS = ("road", "uniform", "highway")
BUS = ("3_default", "3_front")


def told(data):
    """The verdicts by name, and the page in one line."""
    facts = Facts(data)
    text = page(facts)
    return facts.said, " ".join(text.split())


def turned(change):
    """The committed results with their values changed, judged anew."""
    data = copy.deepcopy(COMMITTED)
    values = {name: entry["value"] for name, entry in data["results"].items()}
    change(values)
    data["results"] = {name: {"value": v, "seconds": 60.0} for name, v in values.items()}
    data["claims"] = [claim.to_dict() for claim in claims(values, Facts(data).effort)]
    return data


def words(text):
    """A verdict without its figures: what has to change is the word."""
    return re.sub(r"-?[\d.]+", "#", text)


def test_the_committed_page_is_the_one_of_the_committed_results():
    assert page(Facts(COMMITTED)) == (DOCS / "README.md").read_text("utf-8")


def test_the_committed_verdicts():
    """Read off results.json by hand, for the sentences that matter most."""
    said, _ = told(COMMITTED)
    for key in ("1", "3 default", "3 front", "4"):
        assert said[f"ordering {key}"] == "the same under every prior, and in our own search."
    assert said["ordering 2"].startswith(
        "the same under highway, the reverse under road and uniform"
    )
    assert said["3: corners"] == "the same corners" and said["3: height"] == "about the same height"
    assert said["pitch"].startswith("**The same as in the paper:**")


def test_claims_turned_over_turn_every_ordering():
    data = copy.deepcopy(COMMITTED)
    for claim in data["claims"]:
        claim["holds"] = not claim["holds"]
    before, (after, text) = told(COMMITTED)[0], told(data)
    for key in TEXTS:
        names = [
            n for n in before if n in (f"ordering {key}", key) or n.startswith(f"table: {key},")
        ]
        assert names
        for name in names:
            assert words(after[name]) != words(before[name]), name
    for old in ("same under every prior", "The same as in the paper", "Hold under every prior",
                "The pitch figure holds"):  # fmt: skip
        assert old in told(COMMITTED)[1]
        assert old not in text


# Ways to turn figures over.


def swap(values, one, other):
    """Exchange all results under two prefixes."""
    pairs = [(name, other + name.removeprefix(one)) for name in values if name.startswith(one)]
    assert pairs
    for a, b in pairs:
        values[a], values[b] = values[b], values[a]


def swap_entropies(values, one, other):
    pairs = [(name, other + name.removeprefix(one)) for name in values if name.startswith(one)]
    assert pairs
    for a, b in pairs:
        values[a]["entropy"], values[b]["entropy"] = values[b]["entropy"], values[a]["entropy"]


def swapped_at_the_printed_placements(values):
    swap(values, "printed/1_pandar64", "printed/1_hdl64e")
    swap(values, "printed/2_60deg", "printed/2_120deg")
    swap(values, "printed/3_default", "swapped/3_default")
    swap(values, "printed/3_front", "swapped/3_front")
    swap(values, "printed/4_cameras", "lidars/4_cameras")


def swapped_in_searches(values):
    swap_entropies(values, "search/1_pandar64/road", "search/1_hdl64e/road")
    for prior in ("road", "highway"):
        swap_entropies(values, f"search/2_60deg/{prior}", f"search/2_120deg/{prior}")
    for row, best, other in (("3_default", "diagonal", "front"), ("3_front", "front", "diagonal")):
        swap_entropies(values, f"pilot/{row}/road/{best}", f"pilot/{row}/road/{other}")
        for seed in range(5):
            found = values.pop(f"search/{row}/road/{best}/{seed}")
            values[f"search/{row}/road/{other}/{seed}"] = found
    for seed in range(5):
        values[f"search/4_cameras/road/front/{seed}"]["entropy"] += 5.0


def everything_lower(values):
    for name, value in values.items():
        if name.startswith(("printed/", "lidars/", "swapped/", "search/", "vary/")):
            value["entropy"] -= 30.0


def as_printed(values):
    for name, value in values.items():
        if name.startswith("printed/"):
            value["entropy"] = ROW[name.split("/")[1]].entropy + 0.001


def unseen_costs_less(values):
    """More is seen, at a higher entropy: the means over what is seen rise."""
    for name, value in values.items():
        if name.startswith("printed/"):
            value["coverage"], value["entropy"] = 0.99, value["entropy"] + 10.0
    for prior in PRIORS:
        values[f"printed/2_60deg/{prior}"]["coverage"] = 0.999


def moved(values):
    """Every search ends somewhere else."""
    for name, value in values.items():
        if not name.startswith("search/"):
            continue
        row = name.split("/")[1]
        for sensor, at in value["placements"].items():
            if row[0] == "1":
                at["position"] = [0.1, 0.1, 1.0 + 0.1 * int(name[-1])]
            elif row[0] == "2":
                at["position"] = list(printed(row)[sensor])
                value["coverage"] = 0.01
            elif row in BUS:
                at["position"], at["rotation"] = [at["position"][0], 0.0, 3.3], [0.0, 0.0, 0.0]


def lower_on_the_bus(values):
    for row, start in zip(BUS, ("diagonal", "front"), strict=True):
        values[f"pilot/{row}/road/{start}"]["entropy"] += 0.2 * (row == "3_default")
        for seed in range(5):
            for at in values[f"search/{row}/road/{start}/{seed}"]["placements"].values():
                at["position"][2] = 0.3


def bounds_turned(values):
    for name, value in values.items():
        if name.startswith("bound/"):
            value["least_all_round"], value["most_unseen"] = 0.5, 0.9
        if name.startswith("bound_curve/"):
            value["entropy"] = [v - 10.0 for v in value["entropy"]]


def pitch_turned(values):
    """Equal pitch the lowest, peaks a degree apart, and each LiDAR alone changing more."""
    for name, value in values.items():
        if name.startswith("pitch/"):
            degrees = float(name.removeprefix("pitch/"))
            value["entropy"] = 5.0 - math.cos(2.0 * math.pi * degrees)
            value["alone"]["lidar_b"] = 50.0 * degrees


def varied_turned(values):
    swap(values, "vary/as shipped/1_pandar64", "vary/as shipped/1_hdl64e")
    for name, value in values.items():
        if name.startswith(("vary/voxels", "vary/positions", "vary/expected")):
            value["entropy"] = 30.0 if "positions" in name else 20.0


def fits_turned(values):
    values["fit/paper_lidar"]["a"] += 0.01
    for name in ("car", "pedestrian", "cyclist"):
        fit = values[f"fit/kitti_{name}"]
        fit["a"], fit["left_out"] = 0.05, ["" for _ in fit["m"]]


WAYS = (
    swapped_at_the_printed_placements,
    swapped_in_searches,
    everything_lower,
    as_printed,
    unseen_costs_less,
    moved,
    lower_on_the_bus,
    bounds_turned,
    pitch_turned,
    varied_turned,
    fits_turned,
)


@pytest.fixture(scope="module")
def verdicts():
    """What the page says of the committed figures, and of each way to turn them over."""
    return told(COMMITTED)[0], {way.__name__: told(turned(way)) for way in WAYS}


def test_every_verdict_of_the_page_turns_with_its_figures(verdicts):
    before, ways = verdicts
    assert len(before) > 60
    stuck = [
        name
        for name, old in before.items()
        if not any(words(said.get(name, "")) != words(old) for said, _ in ways.values())
    ]
    assert stuck == []


@pytest.mark.parametrize("way", [way.__name__ for way in WAYS])
def test_nothing_of_an_old_verdict_is_left(verdicts, way):
    """A sentence that the changed figures no longer say is nowhere on the page."""
    before, ways = verdicts
    said, text = ways[way]
    gone = {old for name, old in before.items() if said.get(name) != old}
    gone = {" ".join(old.split()) for old in gone - set(said.values()) if len(old.split()) > 3}
    assert gone
    assert [old for old in gone if re.search(rf"(?<![\d.]){re.escape(old)}", text)] == []


def test_the_orderings_of_swapped_rows_are_reversed(verdicts):
    said, text = verdicts[1]["swapped_at_the_printed_placements"]
    for key in ("1", "3 default", "3 front"):
        assert said[f"ordering {key}"].startswith("the reverse under every prior")
    assert said["ordering 2"].startswith(
        "the same under road and uniform, the reverse under highway"
    )
    assert "same under every prior" not in text


def test_moved_searches_are_neither_above_the_roof_nor_at_the_corners(verdicts):
    said, text = verdicts[1]["moved"]
    assert said["1: above the roof"].endswith("not as") and said["3: corners"] == "other corners"
    mean = 3.3 - (1.16 + 0.85 + 1.05 + 1.03) / 4.0
    assert said["3: height"] == f"{mean:.2f} m higher on average"
    assert "the same corners" not in text and "about the same height" not in text


def test_searches_that_took_no_time_have_a_page():
    data = turned(lambda values: None)
    for entry in data["results"].values():
        entry["seconds"] = 0.0
    assert "one search" in told(data)[1]


@pytest.mark.parametrize(
    ("off_m", "verdict"), [(0.24, "about the same height"), (0.26, "0.26 m higher on average")]
)
def test_about_the_same_height_has_a_number_behind_it(off_m, verdict):
    def raised(values):
        for name, value in values.items():
            if name.startswith(("search/3_default", "search/3_front")):
                for sensor, at in value["placements"].items():
                    at["position"][2] = printed(name.split("/")[1])[sensor][2] + off_m

    assert told(turned(raised))[0]["3: height"] == verdict


VERDICT = re.compile(
    r"\b(same|reverse|higher|lower|better|worse|worst|nearly|nearer|agrees?|steeper|flatter|above|"
    r"rises|always|never|does not hold|strong(ly)?)\b",
    re.IGNORECASE,
)
NO_VERDICTS = (
    "the same, or different and why.",
    "Lower is better.",
    "The first figure of each pair is of the rig that the paper finds better.",
    "A prior with nothing nearer has a higher PE whatever else it looks like.",  # by definition
    "m on average is about the same.",  # states the tolerance
    ", at the same LiDAR placement:",
)


def unconditional(node, chosen=False):
    """Texts of a module that no condition chooses and that no verdict is made of."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):  # a docstring
        return
    if isinstance(node, ast.Subscript):  # a key
        return
    if isinstance(node, ast.Constant) and isinstance(node.value, str) and not chosen:
        yield node.value
    said = isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "say"
    for child in ast.iter_child_nodes(node):
        yield from unconditional(child, chosen or said or isinstance(node, (ast.If, ast.IfExp)))


@pytest.mark.parametrize("path", sorted((ROOT / "pe_report/sections").glob("*.py")), ids=str)
def test_no_verdict_stands_in_a_template(path):
    """Comparative words are chosen by a condition or noted as verdicts, but for plain facts."""
    texts = unconditional(ast.parse(path.read_text("utf-8")))
    sentences = [" ".join(s.split()) for text in texts for s in re.split(r"(?<=[.:])\s", text)]
    assert [s for s in sentences if VERDICT.search(s) and s not in NO_VERDICTS] == []

"""The page's verdicts follow from the results: changed results change the verdicts."""

import ast
import copy
import json
import math
import re

import pytest

from studies.paper.claims import TEXTS, claims
from studies.paper.page import page
from studies.paper.paper import ROW
from studies.paper.reproduce import summary
from studies.paper.result_view import ReproductionResults, printed_positions
from tests.studies.conftest import ROOT

DOCS = ROOT / "docs" / "reproduction"
COMMITTED = json.loads((DOCS / "results.json").read_text("utf-8"))
PRIORS = ("road", "uniform", "highway")
BUS = ("3_default", "3_front")


def verdicts_and_page(data):
    """The verdicts by name, and the page in one line."""
    results = ReproductionResults(data)
    text = page(results)
    return results.verdicts, " ".join(text.split())


def results_with(change):
    """The committed results with their values changed, and the claims that follow from them."""
    data = copy.deepcopy(COMMITTED)
    values = {name: entry["value"] for name, entry in data["results"].items()}
    change(values)
    data["results"] = {name: {"value": v, "seconds": 60.0} for name, v in values.items()}
    data["claims"] = [claim.to_dict() for claim in claims(values, ReproductionResults(data).effort)]
    return data


def without_numbers(text):
    """A verdict without its numbers: the words have to change."""
    return re.sub(r"-?[\d.]+", "#", text)


def test_the_committed_page_is_the_one_of_the_committed_results():
    assert page(ReproductionResults(COMMITTED)) == (DOCS / "README.md").read_text("utf-8")


def test_the_committed_verdicts():
    """Read off results.json by hand, for the sentences that matter most."""
    verdicts, _ = verdicts_and_page(COMMITTED)
    for key in ("1", "3 default", "4"):
        assert verdicts[f"ordering {key}"] == "the same under every prior, and in our own search."
    assert verdicts["ordering 3 front"].endswith("prior; not decided in our own search.")
    assert verdicts["table: 3 front, searched, road"].startswith("**not decided**")
    told = [line for line in summary(COMMITTED).splitlines() if line.startswith("not decided")]
    assert len(told) == 1 and "front counts double (searched, road)" in told[0]
    assert verdicts["head: corners"] == "both end at the paper's corners, to 0.25 m"
    assert verdicts["ordering 2"].startswith(
        "the same under highway, the reverse under road and uniform"
    )
    assert (
        verdicts["3: corners"] == "the same corners"
        and verdicts["3: height"] == "about the same height"
    )
    assert verdicts["pitch"].startswith("**The same as in the paper:**")


def test_claims_turned_over_turn_every_ordering():
    data = copy.deepcopy(COMMITTED)
    for claim in data["claims"]:
        claim["holds"] = not claim["holds"]
    before, (after, text) = verdicts_and_page(COMMITTED)[0], verdicts_and_page(data)
    for key in TEXTS:
        names = [
            n for n in before if n in (f"ordering {key}", key) or n.startswith(f"table: {key},")
        ]
        assert names
        for name in names:  # what chance may have decided is not decided either way
            undecided = "not decided" in before[name] and name.startswith("table")
            turned = without_numbers(after[name]) != without_numbers(before[name])
            assert turned is not undecided, name
    for old in ("same under every prior", "The same as in the paper", "Hold under every prior",
                "The pitch figure holds"):  # fmt: skip
        assert old in verdicts_and_page(COMMITTED)[1]
        assert old not in text


# Changes of the results.


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


def alike_in_all_seeds(values):
    """The seeds of the bus's long searches end alike: two pilots differ by more than chance."""
    for seed in range(5):
        values[f"search/3_front/road/front/{seed}"]["entropy"] = 3.5 + 0.01 * seed


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
                at["position"] = list(printed_positions(row)[sensor])
                value["coverage"] = 0.01
            elif row in BUS:
                at["position"], at["rotation"] = [at["position"][0], 0.0, 3.3], [0.0, 0.0, 0.0]


def lower_on_the_bus(values):
    for row, start in zip(BUS, ("diagonal", "front"), strict=True):
        values[f"pilot/{row}/road/{start}"]["entropy"] += 0.2 * (row == "3_default")
        for seed in range(5):
            for at in values[f"search/{row}/road/{start}/{seed}"]["placements"].values():
                at["position"][2] = 0.3


def bounds_changed(values):
    for name, value in values.items():
        if name.startswith("bound/"):
            value["least_all_round"], value["most_unseen"] = 0.5, 0.9
        if name.startswith("bound_curve/"):
            value["entropy"] = [v - 10.0 for v in value["entropy"]]


def pitch_changed(values):
    """Equal pitch the lowest, peaks a degree apart, and each LiDAR alone changing more."""
    for name, value in values.items():
        if name.startswith("pitch/"):
            degrees = float(name.removeprefix("pitch/"))
            value["entropy"] = 5.0 - math.cos(2.0 * math.pi * degrees)
            value["alone"]["lidar_b"] = 50.0 * degrees


def varied_changed(values):
    swap(values, "vary/as shipped/1_pandar64", "vary/as shipped/1_hdl64e")
    for name, value in values.items():
        if name.startswith(("vary/voxels", "vary/positions", "vary/expected")):
            value["entropy"] = 30.0 if "positions" in name else 20.0


def fits_changed(values):
    values["fit/paper_lidar"]["a"] += 0.01
    for name in ("car", "pedestrian", "cyclist"):
        fit = values[f"fit/kitti_{name}"]
        fit["a"], fit["left_out"] = 0.05, ["" for _ in fit["m"]]


CHANGES = (
    swapped_at_the_printed_placements,
    swapped_in_searches,
    alike_in_all_seeds,
    everything_lower,
    as_printed,
    unseen_costs_less,
    moved,
    lower_on_the_bus,
    bounds_changed,
    pitch_changed,
    varied_changed,
    fits_changed,
)


@pytest.fixture(scope="module")
def pages():
    """Verdicts of the committed results; and verdicts and page of each change of the results."""
    return verdicts_and_page(COMMITTED)[0], {
        change.__name__: verdicts_and_page(results_with(change)) for change in CHANGES
    }


def test_every_verdict_of_the_page_changes_with_its_results(pages):
    before, changed = pages
    assert len(before) > 60
    stuck = [
        name
        for name, old in before.items()
        if not any(
            without_numbers(verdicts.get(name, "")) != without_numbers(old)
            for verdicts, _ in changed.values()
        )
    ]
    assert stuck == []


@pytest.mark.parametrize("change", [change.__name__ for change in CHANGES])
def test_nothing_of_an_old_verdict_is_left(pages, change):
    """A sentence that does not follow from the changed results is nowhere on the page."""
    before, changed = pages
    verdicts, text = changed[change]
    gone = {old for name, old in before.items() if verdicts.get(name) != old}
    gone = {" ".join(old.split()) for old in gone - set(verdicts.values()) if len(old.split()) > 3}
    assert gone
    assert [old for old in gone if re.search(rf"(?<![\d.]){re.escape(old)}", text)] == []


def test_the_orderings_of_swapped_rows_are_reversed(pages):
    verdicts, text = pages[1]["swapped_at_the_printed_placements"]
    for key in ("1", "3 default", "3 front"):
        assert verdicts[f"ordering {key}"].startswith("the reverse under every prior")
    assert verdicts["ordering 2"].startswith(
        "the same under road and uniform, the reverse under highway"
    )
    assert "same under every prior" not in text


def test_moved_searches_are_neither_above_the_roof_nor_at_the_corners(pages):
    verdicts, text = pages[1]["moved"]
    assert (
        verdicts["1: above the roof"].endswith("not as")
        and verdicts["3: corners"] == "other corners"
    )
    mean = 3.3 - (1.16 + 0.85 + 1.05 + 1.03) / 4.0
    assert verdicts["3: height"] == f"{mean:.2f} m higher on average"
    assert "the same corners" not in text and "about the same height" not in text


def test_searches_that_took_no_time_have_a_page():
    data = results_with(lambda values: None)
    for entry in data["results"].values():
        entry["seconds"] = 0.0
    assert "one search" in verdicts_and_page(data)[1]


@pytest.mark.parametrize(
    ("off_m", "verdict"), [(0.24, "about the same height"), (0.26, "0.26 m higher on average")]
)
def test_about_the_same_height_has_a_number_behind_it(off_m, verdict):
    def raised(values):
        for name, value in values.items():
            if name.startswith(("search/3_default", "search/3_front")):
                for sensor, at in value["placements"].items():
                    at["position"][2] = printed_positions(name.split("/")[1])[sensor][2] + off_m

    assert verdicts_and_page(results_with(raised))[0]["3: height"] == verdict


VERDICT = re.compile(
    r"\b(same|reverse|higher|lower|better|worse|worst|nearly|nearer|agrees?|steeper|flatter|above|"
    r"rises|always|never|does not hold|strong(ly)?)\b",
    re.IGNORECASE,
)
NO_VERDICTS = (
    "Lower is better.",
    "The first figure of each pair is of the rig that the paper finds better.",
    "A prior with nothing within them has a higher PE in any case.",  # by definition
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
    is_verdict = isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "verdict"
    for child in ast.iter_child_nodes(node):
        yield from unconditional(
            child, chosen or is_verdict or isinstance(node, (ast.If, ast.IfExp))
        )


SECTIONS = ("page", "tables", "experiment_1", "experiment_2", "experiments_3_and_4")


@pytest.mark.parametrize("name", SECTIONS)
def test_no_verdict_is_part_of_a_template(name):
    """Comparative words are chosen by a condition or noted as verdicts, but for plain results."""
    path = ROOT / "studies" / "paper" / f"{name}.py"
    texts = unconditional(ast.parse(path.read_text("utf-8")))
    sentences = [" ".join(s.split()) for text in texts for s in re.split(r"(?<=[.:])\s", text)]
    assert [s for s in sentences if VERDICT.search(s) and s not in NO_VERDICTS] == []

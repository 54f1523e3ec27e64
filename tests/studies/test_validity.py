"""The published studies: the published placements, the fixed choices, the page and its numbers."""

import copy
import json
import math

import pytest

from studies.published import correlations, scores
from studies.published.__main__ import page, read_results
from studies.published.correlations import ValidityResults, comparisons
from studies.published.scores import CLEAN, DEGREES, RADIANS, box_triangles, paper_of, papers
from studies.published.tasks import QUICK, plan
from tests.studies.conftest import ROOT, study

STUDY = "published"
FOLDER = ROOT / "docs" / "validity"


def test_placements_are_the_published_ones():
    place3d, icra = papers()
    assert list(place3d.placements)[-1] == "ours_det" and len(place3d.placements) == 8
    assert place3d.height("ours_det") == pytest.approx((2.5 + 2.6 + 2.8 + 2.7) / 4)
    assert [s.kind for s in icra.rig("wide+line", DEGREES)] == ["lidar"] * 4 + ["camera"] * 6
    assert place3d.ap[CLEAN]["CenterPoint"]["car"]["trapezoid"] == 55.4


def test_rolls_are_read_both_ways():
    paper = paper_of("place3d")
    assert [n for n in paper.placements if paper.rolled(n)] == [
        "line_roll",
        "pyramid_roll",
        "ours_det",
    ]
    roll = {r: paper.rig("line_roll", r)["lidar_1"].pose.rpy[0] for r in (DEGREES, RADIANS)}
    assert math.degrees(roll[DEGREES]) == pytest.approx(-0.3)
    assert roll[RADIANS] == pytest.approx(-0.3)


def test_every_comparison_has_all_its_placements():
    place3d, icra = papers()
    found = comparisons(place3d)
    assert {c.cls for c in found if c.condition == CLEAN} == {"car", "pedestrian", "cyclist"}
    assert {len(c.placements) for c in found} == {8, 5}
    assert len({c.condition for c in found}) == 7
    assert {len(c.placements) for c in comparisons(icra)} == {8, 4}


def test_a_box_is_turned_counter_clockwise():
    front = box_triangles((1.0, 2.0, 0.5), (4.0, 2.0, 1.0), math.pi / 2)
    assert front.max(axis=(0, 1)).tolist() == pytest.approx([2.0, 4.0, 1.0])


@pytest.mark.thorough
def test_the_quick_run_is_complete(quick):
    values = {name: entry["value"] for name, entry in quick.data["results"].items()}
    assert plan(QUICK, values) == []
    assert all(row["score"] in quick.run.stdout for row in quick.data["over_papers"])


@pytest.fixture(scope="module")
def saved():
    """The committed results, as they stand in their file."""
    return json.loads((FOLDER / "published" / "results.json").read_text("utf-8"))


def test_height_is_what_the_papers_disagree_on(saved):
    """Independent of any score: 0.88 and -0.69, as a table of both papers' cars gives by hand."""
    reading, selection = correlations.MAIN
    rows = [row for row in saved["over_papers"] if row["score"] == "mean height"]
    found = {(row["reading"], row["placements"]): row["rho"] for row in rows}
    assert found[reading, selection] == pytest.approx([0.877, -0.694], abs=1e-3)


def test_scores_are_turned_so_that_higher_is_better(saved):
    values = {name: entry["value"] for name, entry in saved["results"].items()}
    paper = paper_of("place3d")
    by_name = {c.name: c for c in scores.CANDIDATES}
    rating = scores.Rating(paper, "center", DEGREES, "car")
    entropy = values["voxels/alone/place3d/center/degrees/box"]["road"]["per_class"]["car"][
        "entropy"
    ]
    assert by_name["perception entropy, road prior"].value(rating, values) == -entropy
    ap = values["objects/alone/place3d/center/degrees/box/1/fitted"]["per_class"]["car"]["ap"]
    assert by_name["expected AP"].value(rating, values) == ap


def test_holm_is_over_all_scores_compared(saved):
    for treatment in correlations.TREATMENTS:
        rows = [r for r in saved["over_papers"] if (r["reading"], r["placements"]) == treatment]
        assert [row["score"] for row in rows] == [c.name for c in scores.CANDIDATES]
        least = min(row["p"] for row in rows)
        assert min(row["holm"] for row in rows) == pytest.approx(min(1.0, least * len(rows)))


@pytest.mark.thorough
def test_a_changed_score_is_noticed(saved, tmp_path):
    data = copy.deepcopy(saved)
    value = data["results"]["objects/alone/place3d/center/degrees/box/1/fitted"]["value"]
    value["per_class"]["car"]["ap"] = 0.999
    (tmp_path / "results.json").write_text(json.dumps(data))
    run = study("published", "--page-only", "--output", tmp_path)
    assert run.returncode != 0 and run.stderr.count("\n") == 1 and "correlations" in run.stderr


@pytest.fixture(scope="module")
def committed():
    """The committed results: correlations are worked out again from the scores."""
    return ValidityResults(read_results(FOLDER / "published" / "results.json"))


def test_the_page_of_the_docs_is_that_of_its_results(committed):
    """Whole: every word follows from the results."""
    assert (FOLDER / "published" / "README.md").read_text("utf-8") == page(committed)


def test_the_page_of_all_studies_has_their_figures(committed):
    own, road, law, published = (
        json.loads((FOLDER / name).read_text("utf-8"))
        for name in ("own/results.json", "road/results.json", "own/second/law.json",
                     "published/results.json")
    )  # fmt: skip
    told = " ".join((FOLDER / "README.md").read_text("utf-8").split())
    statements = own["statements"]
    afterwards = own["afterwards"]
    rows = [s["figures"] for s in (statements[0], statements[2], statements[3])]
    rows += [afterwards["beyond_coverage"]]
    for row in rows:
        low, high = row["interval"]
        assert f"rho {row['rho']:+.2f} ({low:+.2f} to {high:+.2f})" in told
    pairs = afterwards["fewer_beams"]
    wrong = pairs["wrong"]["perception entropy, road prior"]
    assert f"{wrong} of {pairs['blind']} such pairs" in told
    low, high = afterwards["minus_beams"]["interval"]
    assert f"{afterwards['minus_beams']['share']:+.3f} ({low:+.3f} to {high:+.3f})" in told
    default, kept = (
        {row["figure"]: (row["inside"], sum(row["cells"].values()), row["verdict"]) for row in rows}
        for rows in road["statements"].values()
    )
    for figure in ("ratio", "none"):
        before, of, first = default[figure]
        after, _, last = kept[figure]
        assert f'{before} of {of} cells, `returns = "road"` {after} of {of} |' in told
        assert first == last == "refuted"
    assert default["rho"] == kept["rho"] == (4, 6, "not decided")
    found = law["across"]["mean"]
    w = law["w"]
    low, high = found["interval"]
    assert f"RMSE {found['difference']:.4f} ({low:+.4f} to {high:+.4f})" in told
    assert f"worth {w / (1 - w):.1f} columns, w {w:.2f}" in told
    opposite = len(committed.opposite_in_papers())
    assert f"none of {len(committed.scores)}; {opposite} change their sign" in told
    assert not committed.significant()["always"] and published["over_papers"]

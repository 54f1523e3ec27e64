"""The committed page and its verdicts; other claims turn the verdicts."""

import copy
import json
import re

from studies.paper.claims import TEXTS
from studies.paper.page import page
from studies.paper.reproduce import summary
from studies.paper.result_view import ReproductionResults
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

"""The example page that the README links: self-contained, and written by this version."""

import json
from pathlib import Path

import pytest

import pe_core as pe
from tests.review.dom import parsed, policy_of, tagged_rows

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "reviews" / "four_corners.html"
MAX_BYTES = 2_500_000


@pytest.fixture(scope="module")
def text():
    """The page, as text."""
    return PAGE.read_text("utf-8")


@pytest.fixture(scope="module")
def shown(text):
    """The page, as a tree."""
    return parsed(text)


def test_it_holds_all_it_needs(text, shown):
    policy = policy_of(shown)
    assert policy.startswith("default-src 'none'; ") and "unsafe" not in policy
    assert text.endswith("</html>\n")
    for each in shown:
        for name in ("src", "href", "action"):
            assert each.attributes.get(name, "#").startswith(("#", "data:")), each.tag
        styles = [each.text if each.tag == "style" else "", each.attributes.get("style", "")]
        for style in styles:
            assert "@import" not in style
            addresses = [part.lstrip("\"'") for part in style.split("url(")[1:]]
            assert all(address.startswith("data:") for address in addresses)
    assert PAGE.stat().st_size < MAX_BYTES


def test_its_sensors_are_the_example_s_and_the_search_is_reported(text, shown):
    view = json.loads(shown.one("script", id="data-view-a").text)
    names = [sensor["name"] for sensor in view["sensors"]]
    sides = ("left", "right")
    assert names == [f"{name}_{side}" for name in ("camera", "front", "rear") for side in sides]
    assert "pe optimize blend_assets/examples/four_corners/study.toml" in text


def test_it_shows_the_verdicts_of_the_example_s_requirements_and_all_are_met(shown):
    """The study keeps requirements that its start breaks; the page is of a search that does."""
    study = pe.load_study(ROOT / "blend_assets" / "examples" / "four_corners" / "study.toml")
    names = [each.name for each in study.requirements]
    assert study.limits.keeps_requirements and len(names) == 8
    rows = tagged_rows(shown)
    assert [row for row in rows if row[0] in names] == [(name, ["tag", "met"]) for name in names]
    assert all(tags == ["tag", "met"] for _, tags in rows), "limits, too"
    assert any(each.text.startswith("8 of 8 ") for each in shown.all("b"))


def test_it_is_linked():
    readme, page = (
        path.read_text("utf-8") for path in (ROOT / "README.md", ROOT / "docs" / "review.md")
    )
    assert f"(docs/reviews/{PAGE.name})" in readme and f"(reviews/{PAGE.name})" in page
    assert "(images/four_corners_review.png)" in page

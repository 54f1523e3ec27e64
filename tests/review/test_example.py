"""The example page that the README links: self-contained, and written by this version."""

import json
import re
from pathlib import Path

import pytest

import pe_core as pe

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "reviews" / "four_corners.html"
MAX_BYTES = 2_500_000
ELSEWHERE = r'(?:src|href|action)="(?!#|data:)[^"]*"|url\((?!["\']?data:)|@import'
"""Addresses that a browser would request."""


@pytest.fixture(scope="module")
def shown():
    """The page, as text."""
    return PAGE.read_text("utf-8")


def view(text):
    """The data of a page's 3-D view."""
    return json.loads(re.search(r'id="data-view-a">(.*?)</script>', text, re.S)[1])


def test_it_holds_all_it_needs(shown):
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', shown)[1]
    assert policy.startswith("default-src 'none'; ") and "unsafe" not in policy
    assert shown.endswith("</html>\n")
    drawn = re.sub(r"<script.*?</script>", "", shown, flags=re.S)
    assert re.findall(ELSEWHERE, drawn) == []
    assert PAGE.stat().st_size < MAX_BYTES


def test_its_sensors_are_the_example_s_and_the_search_is_reported(shown):
    names = [sensor["name"] for sensor in view(shown)["sensors"]]
    assert names == ["camera_left", "camera_right", "lidar_left", "lidar_right"]
    assert "pe optimize blend_assets/examples/four_corners/study.toml" in shown


def test_it_shows_the_verdicts_of_the_example_s_requirements_and_all_are_met(shown):
    """The study keeps requirements that its start breaks; the page is of a search that does."""
    study = pe.load_study(ROOT / "blend_assets" / "examples" / "four_corners" / "study.toml")
    names = [each.name for each in study.requirements]
    assert study.limits.keeps_requirements and len(names) == 8
    head = r'<th scope="row">\d ([^<]*)(?:<br><small>[^<]*</small>)?</th>'
    rows = re.findall(head + r'<td><span class="tag ([^"]*)"', shown)
    assert rows == [(name, "met") for name in names]
    assert "<b>8 of 8 requirements are met.</b>" in shown


def test_it_is_linked():
    readme, page = (
        path.read_text("utf-8") for path in (ROOT / "README.md", ROOT / "docs" / "review.md")
    )
    assert f"(docs/reviews/{PAGE.name})" in readme and f"(reviews/{PAGE.name})" in page
    assert "(images/four_corners_review.png)" in page

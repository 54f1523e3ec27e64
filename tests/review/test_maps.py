"""Plans and maps: ahead is to the right and left is up; colours have the meaning in the key."""

import base64
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from pe_core.scoring.sight import GroundSight, reach_text
from pe_tools import graphics
from pe_tools.page.pictures.ground_plan import (
    ENTROPY,
    SENSORS,
    PlanDrawing,
    difference_map,
    ground_map,
)
from pe_tools.page.pictures.sight_plans import side_text
from pe_tools.page.sections.visibility import visibility
from tests.engine.test_masks import decoded
from tests.review.conftest import html_of
from tests.review.dom import parsed


def seen(entropy, sensors=None):
    """A map of 1 m cells round the origin; where the entropy is NaN the vehicle is."""
    nx, ny = entropy.shape
    x, y = ((np.arange(n) + 0.5 - n / 2) for n in (nx, ny))
    number = np.where(np.isfinite(entropy), 1, -1) if sensors is None else sensors
    coverage = np.where(np.isfinite(entropy), 0.5, np.nan)
    return GroundSight(
        x=x,
        y=y,
        step=1.0,
        height=None,
        entropy=entropy,
        coverage=coverage,
        sensors=number,
        kinds=number,
    )


def pixels_of(svg):
    """The picture inside a drawing."""
    image = parsed(svg).one("image").attributes
    return decoded(base64.b64decode(image["href"].partition("base64,")[2]))


def test_a_map_has_ahead_right_and_left_up():
    """One good place, ahead on the left, and the vehicle in the middle."""
    entropy = np.full((6, 4), 16.651)
    entropy[5, 3] = -10.976
    entropy[2:4, 1:3] = np.nan
    pixels = pixels_of(ground_map(seen(entropy), ENTROPY, None, "alt"))
    assert pixels.shape == (4, 6, 4)
    best, worst = (graphics.as_bytes(graphics.VIRIDIS[k]) for k in (-1, 0))
    assert abs(pixels[0, 5, :3].astype(int) - best).max() <= 1
    assert abs(pixels[3, 0, :3].astype(int) - worst).max() <= 1
    assert (pixels[1:3, 2:4, 3] == 0).all() and pixels[..., 3].sum() == 255 * 20


def test_the_key_has_the_colours_of_the_map():
    entropy = np.zeros((4, 2))
    sensors = np.array([[0, 1], [2, 3], [4, 0], [1, 2]])
    svg = ground_map(seen(entropy, sensors), SENSORS, None, "alt")
    pixels = pixels_of(svg)
    for (i, j), number in np.ndenumerate(sensors):
        color = graphics.color_text(graphics.COUNTS[min(number, 3)])
        assert graphics.color_text(pixels[1 - j, i] / 255.0) == color
        assert f'fill="{color}"' in svg
    assert [t for t in ("none", "3 or more") if t in svg] == ["none", "3 or more"]


def test_a_difference_is_blue_where_the_second_is_better():
    one = np.array([[0.0, 0.0, 0.0]])
    two = np.array([[-20.0, 0.0, 20.0]])
    pixels = pixels_of(
        difference_map(seen(one), seen(two), vehicle=None, alt="alt", ends=("better", "worse"))
    )
    right, middle, left = (pixels[k, 0, :3] for k in (2, 1, 0))
    assert right.tolist() == graphics.as_bytes(graphics.DIFFERENCE[2]).tolist()
    assert (
        left.tolist() == graphics.as_bytes(graphics.DIFFERENCE[0]).tolist() and middle.min() > 235
    )


def test_a_plan_has_metres_where_they_are():
    plan = PlanDrawing(((-80.0, 80.0), (-40.0, 40.0)), "alt")
    corners = plan.points(np.array([[-80.0, 40.0], [80.0, -40.0], [0.0, 0.0]]))
    assert corners[0, 0] < corners[1, 0] and corners[0, 1] < corners[1, 1]
    np.testing.assert_allclose(corners[2], corners[:2].mean(axis=0))
    plan.frame()
    texts = {e.text: float(e.get("x")) for e in ET.fromstring(plan.canvas.svg()).iter("text")}
    assert {"80 m", "0", "\N{MINUS SIGN}40"} <= set(texts)
    assert texts["80 m"] == pytest.approx(corners[1, 0], abs=0.1)


def test_the_section_tells_what_the_engine_found(scored):
    html = html_of(visibility, scored)
    assert html.count("<svg") == 9  # four maps, three heights, two classes
    ET.fromstring(f"<div>{html}</div>")
    blind = scored.sight.blind(scored.rig, 0.5)
    for side in ("front", "left"):
        assert f"<td>{side_text(blind, side)}</td>" in html
    reach = scored.sight.reach(scored.rig, "pedestrian")
    assert f"<td>{reach_text(*reach.towards(0.0))}</td>" in html


def test_a_search_shows_before_and_what_changed(searched, bare):
    assert html_of(visibility, searched).count("<svg") == 12
    assert html_of(visibility, bare).count("<svg") == 9  # also without a vehicle

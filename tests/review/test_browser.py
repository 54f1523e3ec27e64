"""The page in a real browser: it complains of nothing, asks nobody, fits, and its view is drawn."""

import re

import pytest

from tests.review.browser import DESKTOP, PHONE, WITHOUT_WEBGL, opened, settle

ON_PAPER = """() => {
  window.dispatchEvent(new Event("beforeprint"));
  const paper = document.querySelector(".v3-paper");
  const { data } = paper.getContext("2d").getImageData(0, 0, paper.width, paper.height);
  const colors = new Map();
  for (let i = 0; i < data.length; i += 4) {
    const color = (data[i] << 16) + (data[i + 1] << 8) + data[i + 2];
    colors.set(color, (colors.get(color) || 0) + 1);
  }
  return { width: paper.width, colors: colors.size, most: 4 * Math.max(...colors.values()) / data.length };
}"""
SIDEWAYS = "() => document.documentElement.scrollWidth - document.documentElement.clientWidth"
UNDRAWN = """() => [...document.images].filter((image) => image.offsetParent)
  .filter((image) => !(image.complete && image.naturalWidth > 0)).map((image) => image.alt)"""


@pytest.fixture(scope="module")
def file(page, tmp_path_factory):
    """The page as a file, in a folder whose name is no plain word."""
    path = tmp_path_factory.mktemp("a page, to hand on") / "review.html"
    path.write_text(page, "utf-8")
    return path


@pytest.fixture(scope="module")
def desktop(chromium, file):
    """The page on a desktop."""
    with opened(chromium, file, DESKTOP) as there:
        yield there


@pytest.fixture
def view(desktop):
    """The desktop's page, as it was when it was opened."""
    page, _ = desktop
    page.reload()
    settle(page)
    return page


def picture(page):
    """What the view shows, without the names over it."""
    settle(page)
    page.add_style_tag(content=".v3-labels { visibility: hidden }")
    return page.locator(".v3-stage").screenshot()


def test_it_complains_of_nothing_and_asks_nobody(desktop):
    page, heard = desktop
    assert heard.complaints == []
    assert heard.asked and all(url.startswith(("file:", "data:", "blob:")) for url in heard.asked)
    assert page.evaluate(UNDRAWN) == []


def test_the_view_is_drawn(view):
    found = view.evaluate(ON_PAPER)
    assert view.locator(".v3-live").is_visible() and view.locator(".v3-still").is_hidden()
    assert found["width"] == 1600 and found["colors"] > 200 and found["most"] < 0.9


def test_a_view_at_rest_is_drawn_the_same_again(view):
    """Else the tests below would pass whatever a switch does."""
    assert picture(view) == picture(view)


@pytest.mark.parametrize("layer", ["sees", "ground"])
def test_a_sensor_s_switch_shows_and_hides(view, layer):
    before, box = picture(view), view.locator(f"input[data-sensor='0'][data-layer='{layer}']")
    box.click()
    changed = picture(view)
    assert changed != before
    box.click()
    assert picture(view) == before


def test_the_switch_of_all_is_that_of_each(view):
    every = view.locator("input[data-all='sees']")
    own = view.locator("input[data-sensor][data-layer='sees']")
    every.click()
    assert [box.is_checked() for box in own.all()] == [False, False]
    own.first.click()
    assert every.evaluate("box => box.indeterminate")


def test_maps_lie_on_the_ground_with_a_legend(view):
    seen = {picture(view)}
    legend = view.locator(".v3-legend")
    assert legend.is_hidden()
    for name, word in (("entropy", "nats"), ("coverage", "%"), ("sensors", "nobody")):
        view.select_option("select[data-map]", name)
        seen.add(picture(view))
        assert word in legend.inner_text()
    assert len(seen) == 4


def test_views_and_looking_from_a_sensor_and_back(view):
    start = picture(view)
    view.click("[data-view='above']")
    above = picture(view)
    view.click("[data-look='1']")
    assert view.locator(".v3-caption").inner_text().startswith("From front & left / 60°")
    assert len({start, above, picture(view)}) == 3
    view.locator(".v3-caption button").click()
    assert picture(view) == start and view.locator(".v3-caption").is_hidden()


def test_it_is_turned_by_mouse_and_keys_and_reset(view):
    start = picture(view)
    view.locator(".v3-stage").focus()
    view.keyboard.press("ArrowLeft")
    turned = picture(view)
    assert turned != start
    view.keyboard.press("0")
    assert picture(view) == start
    box = view.locator(".v3-canvas").bounding_box()
    view.mouse.move(box["x"] + 200, box["y"] + 60)
    view.mouse.down()
    view.mouse.move(box["x"] + 320, box["y"] + 90)
    view.mouse.up()
    assert picture(view) not in (start, turned)


def test_the_wheel_scrolls_the_page_until_the_view_was_pressed(view):
    view.locator(".v3-canvas").hover()
    before, top = picture(view), view.evaluate("scrollY")
    view.mouse.wheel(0, 120)
    view.wait_for_function("top => scrollY > top", arg=top)
    assert picture(view) == before


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_nothing_overflows_sideways(chromium, file, desktop, size):
    if size == DESKTOP:
        assert desktop[0].evaluate(SIDEWAYS) <= 0
        return
    with opened(chromium, file, size) as (page, heard):
        assert page.evaluate(SIDEWAYS) <= 0 and heard.complaints == []
        assert page.locator(".v3-canvas").evaluate("c => c.style.touchAction") != "none"
        page.locator(".v3-canvas").tap(position={"x": 20, "y": 20})
        assert page.locator(".v3-canvas").evaluate("c => c.style.touchAction") == "none"


def test_without_webgl_a_still_picture_is_there(chromium, file):
    with opened(chromium, file, DESKTOP, WITHOUT_WEBGL) as (page, heard):
        assert page.locator(".v3-live").is_hidden() and heard.complaints == []
        still = page.locator(".v3-still img")
        assert still.is_visible() and still.evaluate("image => image.naturalWidth") > 400


def test_it_prints_with_the_view_as_a_picture(desktop):
    page, heard = desktop
    pdf = page.pdf(format="A4", print_background=True)
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) >= 1
    assert re.search(rb"/Width 1600\b", pdf), "the view's own canvas"
    assert heard.complaints == []

"""The page in a real browser: no errors, no requests, no overflow, and the 3-D view works."""

import re

import pytest

from tests.review.browser import DESKTOP, PHONE, WITHOUT_WEBGL, opened

PRINTED = """() => {
  window.dispatchEvent(new Event("beforeprint"));
  const paper = document.querySelector(".v3-paper");
  const { data } = paper.getContext("2d").getImageData(0, 0, paper.width, paper.height);
  const colors = new Map();
  for (let i = 0; i < data.length; i += 4) {
    const color = (data[i] << 16) + (data[i + 1] << 8) + data[i + 2];
    colors.set(color, (colors.get(color) || 0) + 1);
  }
  const most = Math.max(...colors.values());
  return { width: paper.width, colors: colors.size, most: 4 * most / data.length };
}"""
DRAWN = """() => new Promise((done) => {
  window.dispatchEvent(new Event("afterprint"));  // has the view drawn once more
  requestAnimationFrame(() => done(document.querySelector(".v3-canvas").toDataURL()));
})"""
"""Pixels of a view can only be read directly after it is rendered."""
SIDEWAYS = "() => document.documentElement.scrollWidth - document.documentElement.clientWidth"
UNDRAWN = """async () => {
  const sources = [...document.images].map((image) => image.src);
  sources.push(...[...document.querySelectorAll("svg image")].map((image) => image.href.baseVal));
  const undrawn = [];
  for (const source of sources) {
    const image = Object.assign(new Image(), { src: source });
    await image.decode().catch(() => undrawn.push(source.slice(0, 40)));
    if (!image.naturalWidth) undrawn.push(source.slice(0, 40));
  }
  return { count: sources.length, undrawn };
}"""


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
    """The desktop's page, its view as it was when it was opened."""
    page, _ = desktop
    page.select_option("select[data-map]", "")
    for layer, on in (("fov", True), ("occluded", True), ("ground", False)):
        page.locator(f"input[data-all='{layer}']").set_checked(on)
    page.click(".v3-views [data-view='quarter']")
    page.evaluate("() => document.body.dispatchEvent(new Event('pointerdown', {bubbles: true}))")
    return page


def pixels(page):
    """Pixels of the view, without the labels over it."""
    return page.evaluate(DRAWN)


def test_it_complains_of_nothing_and_asks_nobody(desktop):
    page, heard = desktop
    assert heard.complaints == []
    assert heard.asked and all(url.startswith(("file:", "data:", "blob:")) for url in heard.asked)
    images = page.evaluate(UNDRAWN)
    assert images["count"] > 0 and images["undrawn"] == []


def test_the_view_is_drawn(view):
    found = view.evaluate(PRINTED)
    assert view.locator(".v3-live").is_visible() and view.locator(".v3-still").is_hidden()
    assert found["width"] == 1600 and found["colors"] > 200 and found["most"] < 0.9


@pytest.mark.parametrize("layer", ["fov", "ground"])
def test_a_sensor_s_switch_shows_and_hides(view, layer):
    before = pixels(view)
    box = view.locator(f"input[data-sensor='0'][data-layer='{layer}']")
    box.click()
    changed = pixels(view)
    assert changed != before
    box.click()
    assert pixels(view) == before


def test_maps_lie_on_the_ground_with_a_legend(view):
    seen = {pixels(view)}
    legend = view.locator(".v3-stage .v3-legend")
    assert legend.is_hidden()
    for name, word in (("entropy", "nats"), ("coverage", "%"), ("sensors", "nobody")):
        view.select_option("select[data-map]", name)
        seen.add(pixels(view))
        assert word in legend.inner_text()
    assert len(seen) == 4


def test_views_and_looking_from_a_sensor_and_back(view):
    start = pixels(view)
    view.click("[data-view='above']")
    above = pixels(view)
    view.click("[data-look='1']")
    assert view.locator(".v3-caption").inner_text().startswith("From front & left / 60°")
    assert len({start, above, pixels(view)}) == 3
    view.locator(".v3-caption button").click()
    assert pixels(view) == start and view.locator(".v3-caption").is_hidden()
    view.click("[data-look='1']")
    assert pixels(view) != start
    view.keyboard.press("Escape")  # the button that was clicked still has the keys
    assert pixels(view) == start and view.locator(".v3-caption").is_hidden()


def test_it_is_turned_by_mouse_and_keys_and_reset(view):
    start = pixels(view)
    view.locator(".v3-stage").focus()
    view.keyboard.press("ArrowLeft")
    turned = pixels(view)
    assert turned != start
    view.keyboard.press("0")
    assert pixels(view) == start
    box = view.locator(".v3-canvas").bounding_box()
    view.mouse.move(box["x"] + 200, box["y"] + 60)
    view.mouse.down()
    view.mouse.move(box["x"] + 320, box["y"] + 90)
    view.mouse.up()
    assert pixels(view) not in (start, turned)


def test_the_wheel_scrolls_the_page_until_the_view_was_pressed(view):
    view.locator(".v3-canvas").hover()
    before = pixels(view)
    top = view.evaluate("scrollY")
    view.mouse.wheel(0, 120)
    view.wait_for_function("top => scrollY > top", arg=top)
    assert pixels(view) == before


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


def test_without_webgl_a_note_leads_to_the_picture_at_the_top(chromium, file):
    with opened(chromium, file, DESKTOP, WITHOUT_WEBGL) as (page, heard):
        assert page.locator(".v3-live").is_hidden() and heard.complaints == []
        assert page.locator(".v3-still").is_visible()
        picture = page.locator("#summary figure svg")
        assert picture.is_visible() and picture.bounding_box()["width"] > 400


def test_it_prints_with_the_view_as_a_picture(desktop):
    page, heard = desktop
    pdf = page.pdf(format="A4", print_background=True)
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) >= 1
    assert re.search(rb"/Width 1600\b", pdf), "the view's own canvas"
    assert heard.complaints == []

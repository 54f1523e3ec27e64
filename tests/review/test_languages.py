"""The page in other languages: every text but names and figures."""

import re
from html import unescape

import pytest

from pe_tools import languages
from pe_tools.page import About, page_bytes

NAME = re.compile(
    r"LiDAR|Seed|roll|pitch|yaw|nats|deg|AP|Position|Name|Sensor|Zone|\b[0-9a-f]{40,}\b", re.I
)
"""Messages that may be the same in another language."""
FIGURE = re.compile(r"\d+\.\d\d")


@pytest.mark.parametrize("language", languages.LANGUAGES)
def test_every_text_of_the_page_is_in_the_language(language, searched, searched_page):
    """No text that has letters stays English, but for names; figures stay as they are."""
    page = page_bytes([searched], about=About(language=language)).decode()
    own = languages.texts_of(page)
    names = re.compile("|".join(map(re.escape, names_of(searched))))
    untranslated = {
        text
        for text in set(languages.texts_of(searched_page)) & set(own)
        if re.search(r"[A-Za-z]{3}", NAME.sub("", names.sub("", shown(text))))
    }
    assert not untranslated, sorted(untranslated)
    assert f'<html lang="{language}">' in page
    assert sorted(FIGURE.findall(page)) == sorted(FIGURE.findall(searched_page))


def shown(text):
    """A text of HTML without its tags."""
    return unescape(re.sub("<[^>]*>", "", text))


def names_of(context):
    """Names on the page, longest first."""
    sensors = [text for s in context.rig for text in (s.name, s.model.name)]
    own = [*sensors, *context.vehicle.part_names, context.name, "perception-entropy", "DOCTYPE"]
    own += ["Python, NumPy", "html", "PointPillars", "KITTI", "RTM3D", "ICRA", "nuScenes", "CMA-ES"]
    return sorted(own, key=len, reverse=True)


def test_a_language_without_a_catalogue_is_refused():
    with pytest.raises(ValueError, match="language: expected en or de or ja or zh, found xx"):
        About(language="xx")

"""The page as a file: well formed, self-contained, and safe with any names."""

import base64
import hashlib
import json
from datetime import date

import pytest

import pe_core as pe
from pe_tools.page import PAGE, About, page_bytes, write_page
from pe_tools.page.markup import escaped, macros
from pe_tools.page.sections import Section
from tests.review.dom import parsed, policy_of, scripts

PAGES = ["page", "searched_page", "page_of_two", "bare_page"]


@pytest.mark.parametrize("which", PAGES)
def test_elements_are_whole_described_and_ask_for_no_other_file(which, request):
    page = parsed(request.getfixturevalue(which))
    found = [(each.tag, each.attributes) for each in page]
    ids = [attributes["id"] for _, attributes in found if "id" in attributes]
    assert len(ids) == len(set(ids))
    links = [a["href"][1:] for tag, a in found if tag == "a" and "href" in a]
    assert links and set(links) <= set(ids)
    for tag, attributes in found:
        for name in ("src", "href", "data", "srcset", "poster"):
            address = attributes.get(name) or "#"
            assert address.startswith(("data:", "#")), (tag, address[:80])
        assert not [name for name in attributes if name.startswith("on")], tag
        assert tag != "img" or attributes.get("alt")
        assert tag != "th" or attributes.get("scope") in ("col", "row", "rowgroup")
    count = [tag for tag, _ in found].count
    assert count("table") == count("caption")


@pytest.mark.parametrize("which", PAGES)
def test_the_policy_names_every_script_and_style_by_its_hash(which, request):
    """No style attribute is left, which a policy without 'unsafe-inline' would not let through."""
    text = request.getfixturevalue(which)
    page = parsed(text)
    stated = policy_of(page)
    assert "unsafe" not in stated
    body = text.partition("</head>")[2].partition("<script")[0]
    assert " style=" not in body and body.count(" data-s=") > 9
    plain = [each for each in page if each.tag in ("script", "style") and not each.attributes]
    assert len(plain) > 1
    for each in plain:
        digest = base64.b64encode(hashlib.sha256(each.text.encode()).digest()).decode()
        allowed = next(part for part in stated.split("; ") if part.startswith(f"{each.tag}-src"))
        assert f"'sha256-{digest}'" in allowed


def test_a_page_says_what_it_is(scored, monkeypatch):
    monkeypatch.setattr("pe_tools.page.document.SECTIONS", ())
    about = About('<b>Roof & "rails"\\</b>', "A. Author", "2026-05-04", "B")
    text = page_bytes([scored], about=about).decode()
    assert "<h1>&lt;b&gt;Roof &amp; &#34;rails&#34;\\&lt;/b&gt;</h1>" in text
    assert '<p class="about">A. Author, 2026-05-04, Revision B</p>' in text
    assert '<p class="of">a/b &lt;i&gt;c&lt;/i&gt;</p>' in text
    assert '@bottom-left { content: "\\00003cb\\00003eRoof \\000026 ' in text
    assert 'content: counter(page) " / " counter(pages)' in text
    plain = page_bytes([scored]).decode()
    assert 'class="about"' not in plain and page_bytes([scored]).decode() == plain
    assert About(date="Today").date == date.today().isoformat()
    with pytest.raises(pe.InputError, match="title: expected 200 letters at most, found 201"):
        About("a" * 201)


def test_what_does_not_print_is_written_out():
    assert escaped("a\x1b[31m\u202eb\ud800") == "a\\x1b[31m\\u202eb\\ud800"
    assert "<td>1 &lt; 2</td>" in macros().table("t", ["a", "b"], [["x", "1 < 2"]])


def test_scripts_and_styles_stand_once_and_data_by_study(scored, other, monkeypatch):
    name = "</script><!--\u2028&"

    def values(one):
        return {
            "driven": (),
            "strips": (),
            "window": 5,
            "script_data": {"key": one.key, "name": name, "x": [1.5, None]},
        }

    row = Section(
        "try",
        "Try",
        values,
        joint=False,
        template="drive-by",
        scripts=lambda: ("const a = '</script>';",),
    )
    monkeypatch.setattr("pe_tools.page.document.SECTIONS", (row,))
    text = page_bytes([scored, other]).decode()
    assert text.count("const a = '<\\/script>';") == text.count("@page { margin") == 1
    found = scripts(parsed(text), "data-try-")
    assert not any(set(data) & set("<>&\u2028") for data in found.values())
    for key, data in found.items():
        assert json.loads(data) == {"key": key, "name": name, "x": [1.5, None]}
    assert set(found) == {"a", "b"}


def test_a_page_of_ours_is_replaced_another_is_not(scored, tmp_path, monkeypatch):
    monkeypatch.setattr("pe_tools.page.document.SECTIONS", ())
    path = write_page([scored], tmp_path)
    assert path == tmp_path / PAGE and write_page([scored], tmp_path) == path
    path.write_text("mine")
    with pytest.raises(pe.InputError, match=r"review\.html: output: expected no file, or one"):
        write_page([scored], tmp_path)
    assert path.read_text() == "mine"
    assert write_page([scored], tmp_path, replace=True).read_bytes() == page_bytes([scored])

"""Templates write what Jinja writes: small ones, and those of whole pages with their values."""

import jinja2
import pytest

import pe_core as pe
from pe_tools.templating import Markup, Templates, escape
from pe_tools.templating.expressions import TemplateError

ROWS = [{"name": "a<b", "n": 3}, {"name": "c", "n": -1}, {"name": "a<b", "n": None}]
VALUES = {
    "rows": ROWS,
    "table": {"x": 1.5, "items": "hidden"},
    "text": 'it\'s <b> & "q"',
    "html": Markup("<i>x</i>"),
    "pose": pe.Pose((1.0, 2.0, 3.0)),
    "number": 1234567,
    "nothing": None,
    "none_at_all": [],
}
SAME = [
    "plain { text } with % and # signs\n",
    "{{ text }} {{ html }} {{ html ~ text }} {{ text ~ number }} {{ nothing }}",
    "{{ 1 + 2 * 3 - 4 }} {{ 7 // 2 }} {{ 7 % 4 }} {{ 1.5e1 / 3 }} {{ -number }} {{ 5 - -2 }}",
    "{{ 1 ~ 2 * 3 ~ 'x' }}{% for k in range(3) %}{{ k }}{% endfor %}",
    "{{ 1 < 2 <= 2 != 3 }} {{ 2 in [1, 2] }} {{ 2 not in (1, 3) }} {{ not 0 and 1 or 2 }}",
    "{{ 1 if 0 }}{{ 1 if 2 }}{{ 'yes' if rows else 'no' }} {{ 'a' if 0 else 'b' if 0 else 'c' }}",
    "{{ table.x }} {{ table['x'] }} {{ table.items()|list|length }} {{ pose.position[1:] }}",
    "{{ rows[-1].n }} {{ rows[0]['name'] }} {{ pose.position[0] }} {{ [1, 2, 3][:2] }} {{ () }}",
    "{{ '%.2f|%s'|format(1.234, 'x') }} {{ '{:,}'.format(number) }} {{ '%d %d'|format(*[1, 2]) }}",
    "{{ {-1: 'a', 1: 'b'}.get(1, 'c') }} {{ (1, 2)[0] }} {{ ('a') }} {{ [1, [2]|max]|min }}",
    "{{ rows|map(attribute='name')|join(', ') }} {{ [html, text]|join('<') }}",
    "{{ rows|selectattr('n')|list|length }} {{ rows|selectattr('n', 'none')|list|length }}",
    "{{ rows|selectattr('n', 'equalto', 3)|map(attribute='n')|list }}",
    "{{ [1, none]|reject('none')|list }} {{ rows|map('length')|list }}",
    "{{ -3|abs }} {{ (1 - 5)|abs }} {{ [4, 2]|first }} {{ text|replace('<', '(') }}",
    "{{ rows is none }} {{ nothing is none }} {{ text is string }} {{ missing is defined }}",
    "{% for row in rows %}{{ loop.index }}/{{ loop.revindex }} {{ row.name }}\n"
    "{%- if loop.first %} first{% elif loop.last %} last{% else %} mid{% endif %}{% endfor %}",
    "{% for row in rows if row.n %}{{ loop.index0 }}{{ row.n }}{% else %}none{% endfor %}",
    "{% for row in none_at_all %}x{% else %}none{% endfor %}",
    "{% for a, b in ((1, 2), (3, 4),) %}"
    "{% if loop.changed(b - a) %}{{ a }}{% endif %}{{ b }}{% endfor %}",
    "{% set a, b = 1, 2 %}{% for x in [1] %}{% set a = 9 %}{% endfor %}{{ a }}{{ b }}",
    "{% set a %}<b>{{ text }}</b>{% endset %}{{ a }}",
    "{% macro m(x, y=2) %}[{{ x }}{{ y }}{{ number }}]{% endmacro %}{{ m(1) }}{{ m(1, y=text) }}",
    "{% macro m(x) %}<p>{{ caller() }}{{ x }}</p>{% endmacro %}"
    "{% for row in rows %}{% call m(loop.index) %}{{ row.name }}{% endcall %}{% endfor %}",
    "  {# a comment #}\n  {% if 1 %}\n  kept\n    {% endif %}\nafter {# c #} x\n",
    "a  {%- if 1 -%}  b  {%- endif -%}  c\n{{ 1 }}\n  {{ 2 }}\n",
]
WRONG = [
    "{{ missing }}",
    "{{ rows[0].missing }}",
    "{{ 1 + }}",
    "{{ 1 2 }}",
    "{{ a b }}",
    "{{ (1 }}",
    "{{ text|nofilter }}",
    "{% if 1 %}x",
    "{% for x in [1] %}",
    "{% endif %}",
    "{% unknown %}",
    "{{ ? }}",
    "{% set 1 = 2 %}",
]


@pytest.fixture
def both(tmp_path):
    """What our engine and Jinja make of a template."""

    def rendered(text, is_html):
        (tmp_path / "a.html").write_text(text, "utf-8")
        loader = jinja2.FileSystemLoader(tmp_path)
        theirs = jinja2.Environment(
            loader=loader,
            autoescape=is_html,
            trim_blocks=True,
            lstrip_blocks=True,
            undefined=jinja2.StrictUndefined,
        )
        ours = Templates(tmp_path, is_html=is_html).render("a.html", **VALUES)
        return ours, theirs.get_template("a.html").render(VALUES)

    return rendered


@pytest.mark.parametrize("text", SAME)
@pytest.mark.parametrize("is_html", [True, False], ids=["html", "plain"])
def test_a_template_is_as_jinja_renders_it(text, is_html, both):
    """Where nothing is escaped, nothing is markup."""
    if "html" in text and not is_html:
        pytest.skip("of HTML")
    ours, theirs = both(text, is_html)
    assert ours == theirs


@pytest.mark.parametrize("text", WRONG)
def test_what_is_wrong_is_an_error(text, tmp_path):
    (tmp_path / "a.html").write_text(text, "utf-8")
    with pytest.raises(TemplateError):
        Templates(tmp_path).render("a.html", **VALUES)


def test_markup_is_not_escaped_again_and_other_text_is():
    assert escape(escape("<'\">&")) == "&lt;&#39;&#34;&gt;&amp;"
    assert Markup("<b>") + "<" == "<b>&lt;" and "<" + Markup("<b>") == "&lt;<b>"
    assert isinstance("x" + Markup("<b>"), Markup)
    assert Markup("<br>").join(["<", Markup("<i>")]) == "&lt;<br><i>"

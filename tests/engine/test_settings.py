"""Settings that are declared once: their defaults, their keys, and the page that lists them."""

import importlib.util
from pathlib import Path

import pytest

import pe_core as pe
from pe_core.base.setting import REQUIRED, check_settings, settings_of
from pe_core.search import Front, Goals, Stop
from pe_core.study import setting_keys

ROOT = Path(__file__).resolve().parents[2]
SETTINGS = dict(setting_keys())


def settings_page():
    """Return the tool that writes docs/settings.md."""
    spec = importlib.util.spec_from_file_location("page", ROOT / "tools" / "settings_page.py")
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


def test_the_page_of_settings_is_that_of_the_declarations():
    tool = settings_page()
    assert tool.PAGE.read_text("utf-8") == tool.page(), "write it: tools/settings_page.py"


@pytest.mark.parametrize("key", SETTINGS)
def test_a_default_is_one_that_its_rule_allows(key):
    setting = SETTINGS[key]
    if setting.default is not REQUIRED and setting.default is not None:
        assert setting.rule.checked("study", key, setting.default) == setting.default


def test_properties_and_keys_are_unique_and_texts_are_sentences():
    properties = [s.panel.property for s in SETTINGS.values() if s.panel is not None]
    assert len(properties) == len(set(properties)) and len(SETTINGS) == len(list(setting_keys()))
    for setting in SETTINGS.values():
        assert setting.text[0].isupper() and not setting.text.endswith(".")


def test_every_declared_setting_is_a_key_of_the_study_file():
    """A setting of a dataclass that no section lists would be declared for nothing."""
    classes = (pe.Study, pe.Search, pe.Schedule, pe.Constraints, pe.Tolerance, pe.Selection)
    classes += (pe.PerceptionSpace, pe.TargetRule, pe.Reference, pe.Vehicle)
    classes += (Goals, Stop, Front, pe.PerceptionModel)
    classes += (pe.requirements.Zone, pe.requirements.Criterion, pe.requirements.Under)
    declared = sum(len(settings_of(cls)) for cls in classes)
    assert declared == len(SETTINGS)


def test_an_absent_setting_is_not_checked_and_a_wrong_one_names_its_field():
    pe.Constraints(max_height=None)
    with pytest.raises(pe.InputError, match=r"optimize: max_height: expected .*, found -1"):
        pe.Constraints(max_height=-1)
    with pytest.raises(pe.InputError, match=r"tolerance.draws: expected a whole number >= 2"):
        pe.Tolerance(draws=1)
    with pytest.raises(pe.InputError, match=r"space: interval: expected a length"):
        check_settings(broken(pe.PerceptionSpace(), "interval", -1), "space")


def broken(instance, name, value):
    """Return a frozen instance with a value that its class would refuse."""
    object.__setattr__(instance, name, value)
    return instance

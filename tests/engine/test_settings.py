"""Settings that are declared once: their defaults, their keys, and the page that lists them."""

import importlib.util
import sys
from dataclasses import is_dataclass
from pathlib import Path

from pe_core.base.setting import REQUIRED, settings_of
from pe_core.study import setting_keys

ROOT = Path(__file__).resolve().parents[2]
SETTINGS = {row.key: row.setting for row in setting_keys()}


def settings_page():
    """Return the tool that writes docs/settings.md."""
    spec = importlib.util.spec_from_file_location("page", ROOT / "tools" / "settings_page.py")
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


def test_the_page_of_settings_is_that_of_the_declarations():
    tool = settings_page()
    assert tool.PAGE.read_text("utf-8") == tool.page(), "write it: tools/settings_page.py"


def test_a_default_is_one_that_its_rule_allows():
    for key, setting in SETTINGS.items():
        if setting.default is not REQUIRED and setting.default is not None:
            assert setting.rule.checked("study", key, setting.default) == setting.default


def test_properties_and_keys_are_unique_and_texts_are_sentences():
    of_scene = [r.setting.panel.property for r in setting_keys(of_scene=True) if r.setting.panel]
    assert len(of_scene) == len(set(of_scene)) and len(SETTINGS) == len(list(setting_keys()))
    for setting in SETTINGS.values():
        assert setting.text[0].isupper() and not setting.text.endswith(".")


def test_every_declared_setting_is_a_key_of_the_study_file():
    """A setting of a dataclass that no document holds would be declared for nothing."""
    declared = {
        (name, setting.text)
        for file, module in sys.modules.items()
        if file.startswith("pe_core.")
        for cls in vars(module).values()
        if isinstance(cls, type) and is_dataclass(cls)
        for name, setting in settings_of(cls).items()
    }
    assert {(each.name, each.text) for each in SETTINGS.values()} == declared

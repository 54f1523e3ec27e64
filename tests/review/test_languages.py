"""The page in other languages."""

import pytest

from pe_tools.page import About


def test_a_language_without_a_catalogue_is_refused():
    with pytest.raises(ValueError, match="language: expected en or de or ja or zh, found xx"):
        About(language="xx")

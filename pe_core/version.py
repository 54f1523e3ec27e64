"""The version: pyproject.toml takes it from here; the extension's manifest has the same."""

__version__ = "0.1.0"

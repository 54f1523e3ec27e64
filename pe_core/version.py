"""The version: pyproject.toml takes it from here, the build of the extension checks its manifest."""

__version__ = "0.1.0"

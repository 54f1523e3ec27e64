"""The version, said once for the engine; pyproject.toml and the add-on agree with it."""

__version__ = "0.1.0"

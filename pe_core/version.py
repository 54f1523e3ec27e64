"""Version of the engine; pyproject.toml and the add-on's manifest have the same."""

__version__ = "0.1.0"

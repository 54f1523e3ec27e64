"""The version; the extension's manifest has the same."""

__version__ = "0.1.0"

"""The version, and the address of the home page; pyproject.toml and the manifest have the same."""

__version__ = "0.1.0"
WEBSITE = "https://extensions.blender.org/add-ons/perception-entropy/"
"""The extension's page; it is there from the first release on."""

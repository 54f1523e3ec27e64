"""What ``pe --version`` prints. Nothing is imported for it that takes long."""

import platform
from importlib.metadata import version

from pe_core.version import __version__


def versions_text() -> str:
    """Return the versions of the program, NumPy and Python, and the machine."""
    numpy = f"NumPy {version('numpy')}"
    return f"pe {__version__}, {numpy}, Python {platform.python_version()}, {platform.platform()}"

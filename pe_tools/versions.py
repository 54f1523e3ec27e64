"""What ``pe --version`` prints. Nothing is imported for it that takes long."""

import platform
import sys

from pe_core.version import __version__


def versions_text() -> str:
    """Return the versions of the program, NumPy and Python, and the machine."""
    numpy = f"NumPy {numpy_version()}"
    return f"pe {__version__}, {numpy}, Python {platform.python_version()}, {platform.platform()}"


def numpy_version() -> str:
    """Return the version of NumPy."""
    if "numpy" in sys.modules:
        return str(sys.modules["numpy"].__version__)
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("numpy")
    except PackageNotFoundError:  # copied into a folder without what pip notes of it
        import numpy

        return numpy.__version__

"""Perception entropy of a vehicle's LiDARs and cameras: the engine, pure NumPy.

The metric is from Ma, Liu and Li, "Perception Entropy: A Metric for Multiple Sensors Configuration
Evaluation and Design", ICRA 2021. Lower is better.

The names in `pe_core.public` and in `pe_tools.public` are here too. They are loaded when one is
first asked for: NumPy takes a while, and the command has to answer Ctrl-C meanwhile.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a checker knows these names, and no others
    from pe_tools.public import *  # noqa: F403

    from .public import *  # noqa: F403
else:
    _PUBLIC = (f"{__name__}.public", f"{__name__.removesuffix('pe_core')}pe_tools.public")

    def __getattr__(name: str) -> object:
        if not name.startswith("__") and find_spec(f"{__name__}.{name}"):
            return import_module(f".{name}", __name__)
        if name == "__all__":
            return sorted(_names())
        for module in map(import_module, _PUBLIC):
            if name in module.__all__:
                value = globals()[name] = getattr(module, name)
                return value
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def _names() -> set[str]:
        return {name for module in map(import_module, _PUBLIC) for name in module.__all__}

    def __dir__() -> list[str]:
        return sorted({*globals(), *_names()})

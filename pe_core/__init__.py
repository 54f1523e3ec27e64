"""Perception entropy of a vehicle's LiDARs and cameras: the engine, pure NumPy.

The metric is from Ma, Liu and Li, "Perception Entropy: A Metric for Multiple Sensors Configuration
Evaluation and Design", ICRA 2021. Lower is better.

The names in `public` are here too. They are loaded when one is first asked for: NumPy takes a
while, and the command has to answer Ctrl-C meanwhile.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a checker knows these names, and no others
    from .public import *  # noqa: F403
    from .public import __all__ as __all__
else:

    def __getattr__(name: str) -> object:
        if not name.startswith("__") and find_spec(f"{__name__}.{name}"):
            return import_module(f".{name}", __name__)
        public = import_module(".public", __name__)
        if name != "__all__" and name not in public.__all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = globals()[name] = getattr(public, name)
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *import_module(".public", __name__).__all__})

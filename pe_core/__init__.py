"""Perception entropy of a vehicle's LiDARs and cameras: the engine, pure NumPy.

The metric is from Ma, Liu and Li, "Perception Entropy: A Metric for Multiple Sensors Configuration
Evaluation and Design", ICRA 2021. Lower is better.

The names in `pe_core.public` are here too. They are loaded when one is first asked for: NumPy takes
a while, and the command has to answer Ctrl-C meanwhile.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a checker knows these names, and no others
    from .public import *  # noqa: F403
else:
    from .lazy_faces import public_names

    __getattr__, __dir__ = public_names(__name__)

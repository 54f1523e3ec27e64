"""How sure a search is of its result: flatness, shadow prices, other optima, flattery.

All of it is evaluated on voxels that the search has not seen. Nothing here changes a result.
"""

from .analysis import Flattery, Sensitivity, analyse, budget_of, is_analysed
from .archive import Archive
from .flatness import FAR, FLAT, NEAR, STEEP, AxisCost
from .fresh_samples import Difference, FreshSamples, fresh_objectives
from .moves import PoseStep
from .optima import Endings, RunnerUp
from .reading import sensitivity_from_dict
from .shadow_prices import ShadowPrice
from .sizes import SizeGain
from .wording import sensitivity_lines, size_gain_text, size_text

__all__ = [
    "FAR",
    "FLAT",
    "NEAR",
    "STEEP",
    "Archive",
    "AxisCost",
    "Difference",
    "Endings",
    "Flattery",
    "FreshSamples",
    "PoseStep",
    "RunnerUp",
    "Sensitivity",
    "ShadowPrice",
    "SizeGain",
    "analyse",
    "budget_of",
    "fresh_objectives",
    "is_analysed",
    "sensitivity_from_dict",
    "sensitivity_lines",
    "size_gain_text",
    "size_text",
]

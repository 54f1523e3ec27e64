"""How sure a search is of its result: flatness, active constraints, other optima.

All of it is evaluated on voxels that the search has not seen. Nothing here changes a result.
"""

from .analysis import Sensitivity, analyse, budget_of, is_analysed
from .archive import Archive
from .flatness import NEAR
from .fresh_samples import Difference, FreshSamples, fresh_objectives
from .reading import sensitivity_from_dict
from .wording import gain_text, sensitivity_lines

__all__ = [
    "NEAR",
    "Archive",
    "Difference",
    "FreshSamples",
    "Sensitivity",
    "analyse",
    "budget_of",
    "fresh_objectives",
    "gain_text",
    "is_analysed",
    "sensitivity_from_dict",
    "sensitivity_lines",
]

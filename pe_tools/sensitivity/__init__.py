"""How sure a search is of its result: flatness, active constraints, other optima.

All of it is evaluated on voxels that the search has not seen. Nothing here changes a result.
"""

from .analysis import Sensitivity as Sensitivity
from .analysis import analyse as analyse
from .analysis import budget_of as budget_of
from .analysis import gain_text as gain_text
from .analysis import is_analysed as is_analysed
from .analysis import sensitivity_from_dict as sensitivity_from_dict
from .analysis import sensitivity_lines as sensitivity_lines
from .flatness import NEAR as NEAR
from .fresh_samples import Difference as Difference
from .fresh_samples import FreshSamples as FreshSamples
from .fresh_samples import fresh_objectives as fresh_objectives
from .optima import Archive as Archive

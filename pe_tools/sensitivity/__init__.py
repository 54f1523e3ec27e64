"""How sure a search is of its result: flatness, active constraints, other optima.

All of it is evaluated as the search did, on its finest sample. Nothing here changes a result.
"""

from .analysis import Sensitivity as Sensitivity
from .analysis import analyse as analyse
from .analysis import budget_of as budget_of
from .analysis import sensitivity_from_dict as sensitivity_from_dict
from .analysis import sensitivity_lines as sensitivity_lines
from .flatness import NEAR as NEAR
from .flatness import StepCosts as StepCosts
from .optima import Archive as Archive

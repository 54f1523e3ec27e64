"""How sure a search is of its result: flatness, active constraints, other optima. All of it is
evaluated as the search did, on its finest sample. Nothing here changes a result."""

from .analysis import Sensitivity, analyse, budget_of, sensitivity_lines
from .flatness import NEAR, StepCosts
from .optima import Archive

"""The page, section by section: templates whose verdicts are chosen from figures by `words`.

Whatever a section says of its figures it says through `Facts.say`, which notes it: a test turns
the figures over and looks whether each verdict turns.
"""

from .experiment_1 import experiment_1
from .experiment_2 import experiment_2
from .experiment_3 import experiment_3
from .experiment_4 import experiment_4
from .head import head
from .made import how_made
from .others import ap_curve, priors
from .pitch import pitch
from .sensitivity import sensitivity
from .tables import orderings, rows

SECTIONS = (
    head,
    orderings,
    rows,
    experiment_1,
    experiment_2,
    experiment_3,
    experiment_4,
    pitch,
    sensitivity,
    ap_curve,
    priors,
    how_made,
)
"""In the order of the page."""

__all__ = ["SECTIONS"]

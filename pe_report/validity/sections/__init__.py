"""The page of ``pe validate``, section by section; verdicts go through `ValidityFacts.say`."""

from .compared import compared
from .conclusion import conclusion
from .each import by_class, by_condition, ranges
from .evidence import evidence
from .head import head
from .made import made
from .one_test import one_test
from .settle import settle

SECTIONS = (
    head,
    evidence,
    compared,
    one_test,
    by_class,
    ranges,
    by_condition,
    conclusion,
    settle,
    made,
)
"""In the order of the page."""

__all__ = ["SECTIONS"]

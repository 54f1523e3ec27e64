"""Methods of search by name: a module and a row of `METHODS` each; `method` has the interface."""

from ...base.errors import InputError
from ...base.values import choice
from . import portfolio, random_search
from .method import Given, Method, Question

METHODS: dict[str, Method] = {
    "portfolio": Method(
        "Portfolio",
        "A survey of each sensor's range; then all sensors at once, and one at a time, in turn",
        portfolio.ask,
        portfolio.samples,
    ),
    "random": Method(
        "Random",
        "Algorithm 1 of the paper: random search in a shrinking neighbourhood",
        random_search.ask,
    ),
}
"""What menus list."""
DEFAULT_METHOD = "portfolio"
SCHEDULED_METHOD = "random"
"""The method of a search that names none, and the only one with a schedule."""


def checked_method(source: str, name: object, scheduled: bool = False) -> str:
    """Return the name of a method, the default for None, or raise `InputError`. A schedule chooses
    no method: one that is `scheduled` has to be named."""
    if name is None and scheduled:
        expected = f"{SCHEDULED_METHOD!r} named with a schedule, which it alone has"
        raise InputError(source, "method", expected, "none named")
    if name is None:
        return DEFAULT_METHOD
    return choice(source, "method", name, tuple(METHODS))

"""The Pareto front of price against entropy, and a search for it over designs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from .designs import DesignSpace, Picks

Worth = tuple[float, float]
"""A price and an entropy [nats]: of both, less is better."""
ALL_UP_TO = 200
"""Of so many designs every one is looked at; of more, those that the local search comes across."""
MOST_LOOKED_AT = 400
"""DesignSpace that the local search looks at."""


def pareto_front(worths: Sequence[Worth]) -> list[int]:
    """Return which of some worths nothing beats, cheapest first; of equal ones the first.

    One beats another when it costs no more, its entropy is no higher, and it is not the same.
    """
    best, front = float("inf"), []
    for number in sorted(range(len(worths)), key=lambda k: (*worths[k], k)):
        if worths[number][1] < best:
            best = worths[number][1]
            front.append(number)
    return front


def above_front(worths: Sequence[Worth]) -> list[float]:
    """Return how much higher each entropy is than the lowest that costs no more [nats]."""
    return [
        entropy - min(other for cost, other in worths if cost <= price) for price, entropy in worths
    ]


class DesignSearch:
    """Which designs to look at: all of a few, or by Pareto local search.

    The local search begins with the design whose sites take their cheapest options in turn, and
    looks at all neighbours of every design that is on the front so far, until none is new (Paquete,
    Chiarandini and Stuetzle, 2004). It draws nothing.

    Parameters
    ----------
    designs : DesignSpace

    Attributes
    ----------
    is_complete : bool
        Whether every design is looked at.
    most : int
        DesignSpace that are looked at, at most.
    """

    def __init__(self, designs: DesignSpace) -> None:
        self._designs = designs
        some = designs.first(ALL_UP_TO + 1)
        self.is_complete = len(some) <= ALL_UP_TO
        self._known: set[Picks] = set()
        self._expanded: set[Picks] = set()
        self._next = some if self.is_complete else some[:1]
        self.most = len(some) if self.is_complete else MOST_LOOKED_AT

    def ask(self) -> list[Picks]:
        """Return designs to look at next; none when the search is over."""
        room = ALL_UP_TO if self.is_complete else MOST_LOOKED_AT - len(self._known)
        asked = self._next[:room]
        self._known.update(asked)
        return asked

    def tell(self, entropies: Mapping[Picks, float]) -> None:
        """Take the entropies of all designs that were looked at so far [nats]."""
        self._next = [] if self.is_complete else list(self._new(entropies))

    def _new(self, entropies: Mapping[Picks, float]) -> Iterator[Picks]:
        seen, looked = list(entropies), set(self._known)
        worths = [(self._designs.price(picks), entropies[picks]) for picks in seen]
        for number in pareto_front(worths):
            if seen[number] in self._expanded:
                continue
            self._expanded.add(seen[number])
            for picks in self._designs.neighbours(seen[number]):
                if picks not in looked:
                    looked.add(picks)
                    yield picks

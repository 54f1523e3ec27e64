"""What results.json says, by question."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from pe_core.metric import H_BLIND

from .claims import best_search
from .effort import from_dict
from .paper import PRIORS, ROW

LEAST_S = 1e-3
"""The ledger's smallest step."""


class Facts:
    """Look-ups in complete results; `said` has the verdicts that were drawn from them, by name."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.made: Mapping[str, Any] = data["made"]
        self.claims: Sequence[Mapping[str, Any]] = data["claims"]
        self.values = {name: entry["value"] for name, entry in data["results"].items()}
        self.seconds = {name: entry["seconds"] for name, entry in data["results"].items()}
        self.said: dict[str, str] = {}
        self.effort = from_dict(self.made["effort"])

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    def say(self, name: str, words: str) -> str:
        """Note a verdict by name, and return its words."""
        self.said[name] = words
        return words

    def named(self, prefix: str) -> dict[str, Any]:
        """Return what begins with a prefix, by the rest of its name."""
        return {k.removeprefix(prefix): v for k, v in self.values.items() if k.startswith(prefix)}

    def entropy(self, row: str, prior: str = PRIORS[0], kind: str = "printed") -> float:
        """Entropy of a row's rig at the printed placement."""
        found: float = self.values[f"{kind}/{row}/{prior}"]["entropy"]
        return found

    def in_view(self, row: str, prior: str) -> float:
        """Mean entropy of the voxels that a row's rig sees, at the printed placement."""
        score = self.values[f"printed/{row}/{prior}"]
        covered: float = score["coverage"]
        return (score["entropy"] - (1.0 - covered) * H_BLIND) / covered

    def searched(self, row: str, prior: str = PRIORS[0]) -> bool:
        """Whether a row was searched."""
        return bool(best_search(self.values, self.effort, row, prior))

    def best(self, row: str, prior: str = PRIORS[0]) -> Mapping[str, Any]:
        """Return a row's best search."""
        found: Mapping[str, Any] = self.values[best_search(self.values, self.effort, row, prior)]
        return found

    def best_start(self, row: str, prior: str = PRIORS[0]) -> str:
        """Return the start of a row's best search."""
        return best_search(self.values, self.effort, row, prior).split("/")[3]

    def seeds(self, row: str, prior: str = PRIORS[0]) -> list[Mapping[str, Any]]:
        """Return the searches of all seeds from the best start."""
        start = f"search/{row}/{prior}/{self.best_start(row, prior)}/"
        return list(self.named(start).values())

    def ends(self, row: str, prior: str = PRIORS[0]) -> list[Mapping[str, Any]]:
        """Placements at the end of every search from the best start."""
        return [search["placements"] for search in self.seeds(row, prior)]

    def spread(self, row: str, prior: str = PRIORS[0]) -> str:
        """Mean and standard deviation over the seeds."""
        found = [search["entropy"] for search in self.seeds(row, prior)]
        if len(found) < 2:
            return ""
        return f"{statistics.mean(found):.3f} ± {statistics.stdev(found):.3f}"

    def search_seconds(self) -> list[float]:
        """Seconds of all searches, none so short that it rounds to nothing."""
        found = [s for name, s in self.seconds.items() if name.startswith("search/")]
        return [max(s, LEAST_S) for s in found]

    def holding(self, experiment: str, where: str) -> tuple[list[str], list[str]]:
        """Priors under which an ordering holds, and does not."""
        about = [c for c in self.claims if (c["experiment"], c["where"]) == (experiment, where)]
        verdicts = (True, False)
        yes, no = ([c["prior"] for c in about if c["holds"] is v] for v in verdicts)
        return yes, no

    def reversed(self, experiment: str, priors: Sequence[str]) -> bool:
        """Whether the rig the paper finds worse is lower at its placements, under some priors."""
        found = [self.claim(experiment, "printed", prior) for prior in priors]
        return all(c["worse_entropy"] < c["better_entropy"] for c in found)

    def claim(self, experiment: str, where: str, prior: str = PRIORS[0]) -> Mapping[str, Any]:
        """Return one ordering's verdict."""
        key = (experiment, where, prior)
        return next(c for c in self.claims if (c["experiment"], c["where"], c["prior"]) == key)


def placement_text(placements: Mapping[str, Any]) -> str:
    """Return x, y, z [m] and pitch [deg] of every sensor."""
    return "; ".join(
        "({:.2f}, {:.2f}, {:.2f}), {:.1f}°".format(*p["position"], p["rotation"][1])
        for p in placements.values()
    )


def printed_text(row: str) -> str:
    """Return the paper's placement of a row."""
    from .problems import study_of

    rig = study_of(row).rig
    return placement_text(
        {s.name: {"position": s.pose.position, "rotation": s.pose.rotation_deg} for s in rig}
    )


def label(row: str) -> str:
    """Return a row's number and name."""
    return f"{ROW[row].experiment} {ROW[row].label}"

"""The figure that a search improves, as people read it: entropy, or expected AP in traffic. A
search minimises one value. By expected AP the value is minus the AP, which nobody is shown."""

from dataclasses import dataclass

from pe_core.search import Value
from pe_core.search.figures import AP
from pe_core.study.condition_table import is_by_ap, searched_study
from pe_core.study.study import ENTROPY, EXPECTED_AP, Study


@dataclass(frozen=True, slots=True)
class SearchedFigure:
    """The figure that a search improves: its name in files and in sentences. The figure is `sign`
    times the value that the search minimises."""

    key: str
    label: str
    sign: float

    @property
    def higher_is_better(self) -> bool:
        """Whether a search raises the figure."""
        return self.sign < 0.0

    def target(self, study: Study) -> float | None:
        """Return the figure that ends the study's search: the limit on it that is kept."""
        key = AP if self.higher_is_better else self.key
        return study.limits.kept_value(key)

    def to_figure(self, value: Value) -> float:
        """Return the figure of a value that a search minimises; it keeps all constraints."""
        return self.sign * value.objective

    def to_value(self, figure: float) -> Value:
        """Return the value that a search minimises of a figure."""
        return Value(0.0, self.sign * figure)

    def cells(self, value: Value) -> tuple[float | None, float]:
        """Return the figure of a value, None where there is none, and its violation."""
        return self.to_figure(value) if value.is_feasible else None, value.violation

    def amount(self, figure: str) -> str:
        """Return a figure in a sentence: "0.50 nats", "an expected AP of 0.65"."""
        return f"an expected AP of {figure}" if self.higher_is_better else f"{figure} nats"

    def text(self, value: Value) -> str:
        """Return a placement's value as text: the figure, or by how much it breaks constraints."""
        if not value.is_feasible:
            return f"constraints broken by {value.violation:.3f}"
        return f"{self.label} {self.to_figure(value):.3f}"

    def ended(self, value: Value) -> str:
        """Return where a search ended: "at 0.500 nats", "with constraints broken by 0.473"."""
        if not value.is_feasible:
            return f"with {self.text(value)}"
        return f"at {self.amount(f'{self.to_figure(value):.3f}')}"


IN_NATS = SearchedFigure(ENTROPY, "entropy", 1.0)
IN_AP = SearchedFigure(EXPECTED_AP, "expected AP", -1.0)
FIGURES = {figure.key: figure for figure in (IN_NATS, IN_AP)}


def searched_samples(study: Study, samples: int) -> int:
    """Return what stands for a level's number of voxels: by expected AP, half on the last level. A
    scene takes long to evaluate. So a search looks at no more than half of the study's scenes, and
    its result is scored on all of them."""
    half = study.search.samples // 2
    return min(samples, half) if is_by_ap(study) and half else samples


def searched_on(study: Study) -> tuple[str, str]:
    """Return on what a study's search evaluates: "16,384, then 65,536" and "voxels"."""
    unit = "scenes of objects" if searched_study(study).targets.are_objects else "voxels"
    return ", then ".join(dict.fromkeys(level_sizes(study))), unit


def level_sizes(study: Study) -> list[str]:
    """Return how many voxels or scenes each level of a study's search has: "16,384", "all"."""
    searched = searched_study(study)
    few = [searched_samples(study, samples) for samples in study.level_samples]
    looks = [searched.scene_count(samples) for samples in few]
    return [f"{n:,}" if n else "all" for n in looks]


def searched_figure(study: Study) -> SearchedFigure:
    """Return the figure that a study's search improves."""
    return FIGURES[study.search.objective]

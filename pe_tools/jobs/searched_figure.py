"""The figure that a search improves, as people read it: entropy, or expected AP in traffic. A
search minimises one value. By expected AP the value is minus the AP, which nobody is shown."""

from dataclasses import dataclass

from pe_core.search import Figure, Value
from pe_core.search.figures import AP, figure_of
from pe_core.study.condition_table import is_by_ap, searched_study
from pe_core.study.study import ENTROPY, EXPECTED_AP, Study


@dataclass(frozen=True, slots=True)
class SearchedFigure:
    """The figure that a search improves: its key in files, and its name in `FIGURES`, or that of a
    function from Python."""

    key: str
    name: str

    @property
    def row(self) -> Figure:
        """How it is called, and which way is better."""
        return figure_of(self.name)

    @property
    def label(self) -> str:
        """Its label within a sentence."""
        return self.row.name

    @property
    def higher_is_better(self) -> bool:
        """Whether a search raises the figure."""
        return self.row.higher

    def target(self, study: Study) -> float | None:
        """Return the figure that ends the study's search: the limit on it that is kept."""
        return study.limits.kept_value(self.name)

    def to_figure(self, value: Value) -> float:
        """Return the figure of a value that a search minimises; it keeps all constraints."""
        return self.row.signed(value.objective)

    def to_value(self, figure: float) -> Value:
        """Return the value that a search minimises of a figure."""
        return Value(0.0, self.row.signed(figure))

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


IN_NATS = SearchedFigure(ENTROPY, ENTROPY)
IN_AP = SearchedFigure(EXPECTED_AP, AP)


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
    return IN_AP if is_by_ap(study) else IN_NATS

"""A study: everything that a run needs, the same for every front end.

Panel, headless Blender and the command line all build a `Study` and give it to the same jobs, which
is why they agree to the bit.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, Any

from .. import catalog
from ..base.arrays import ReadOnlyDict
from ..base.errors import InputError, require_kind, shown
from ..base.notebook import ShortRepr, Tabular
from ..base.setting import OneOf, Panel, Part, Several, check_settings, setting
from ..base.values import A_NAME, A_PATH, Whole
from ..geometry.grids import PerceptionSpace
from ..metric.frames import Frames
from ..motion import Confirmation, DriveBy, Scenario, checked_scenarios, drive_by
from ..prior import HIGHWAY_CLASSES, ROAD_CLASSES
from ..prior.prior import Prior
from ..scene.mesh import MeshAxes, require_vehicle_size
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from ..scene.vehicle_description import Reference, vehicle_line
from ..scoring import Evaluator, RigEvaluator
from ..scoring.requirements import (
    BODIES,
    CheckStep,
    Requirement,
    RequirementChecker,
    Verdict,
    checked_requirements,
)
from ..scoring.sampling import CENTERED, FIRST_SAMPLES, SAMPLES_OR_GRID, Shift
from ..scoring.sight import Sight
from ..scoring.targets import ObjectEvaluator, TargetRule
from ..search import (
    AXES,
    FIGURES,
    METHODS,
    PAPER_FREE,
    SCHEDULED_METHOD,
    SHOWN,
    DesignSpace,
    Goals,
    Limits,
    Mounting,
    MountingGrid,
    Parametrization,
    Schedule,
    SearchRun,
    SearchSpace,
    Selection,
    Tolerance,
    checked_axes,
    checked_bounds,
    checked_method,
    rig_on_mounts,
)
from ..search.key_figures import KeyFigures, shown_figures
from ..search.placement import housings_of
from ..sensors import PerceptionModel
from ..sensors.lidar import ALL, RETURNS
from ..sensors.weather import with_returns
from .conditions import (
    ConditionedChecker,
    Conditions,
    StateInWeather,
    check_classes,
    mounting_cases,
)
from .vehicle_edges import Edge, VehicleEdges, checked_edges

ENTROPY = "entropy"
EXPECTED_AP = "expected_ap"
OBJECTIVES = (ENTROPY, EXPECTED_AP)
"""What a search improves."""
DEFAULT_SEARCH_SAMPLES = 65_536
SEED = Whole(0, 2**63 - 1)
"""The range of whole numbers of a TOML file."""
FEW_SCENES = 32
"""A search's coarsest level has at least so many scenes, if the study has them."""
OPTIONAL = ("vehicle", "reference")


@dataclass(frozen=True, slots=True)
class Search(ShortRepr):
    """How to optimize.

    `InputError` when an axis is none, bounds are not low before high, or a number is out of its
    range.

    Parameters
    ----------
    free : mapping of sensor name to axes
        Which of x, y, z, roll, pitch, yaw each sensor may change.
    limits : mapping of sensor name to mapping of axis to (low, high)
        Bounds that replace the default ones; metres and radians.
    samples : int
        Voxels a candidate is evaluated on; 0: all.
    schedule : Schedule
        Of the method "random", and of the screening of a choice of sensors.
    mounting : Mounting
        Mounts, pairs, groups and constraints.
    method : str
        A name of `METHODS`; by default `DEFAULT_METHOD`. Needed where a schedule is given.
    evaluations : int
        Placements evaluated at most; 0: as many as the method takes.
    tolerance : Tolerance
        Mounting errors and failures that a candidate is evaluated with; none by default.
    grid : MountingGrid
        The steps of positions and angles that a search ends on; none by default.
    goals : Goals
        When to stop, what stays, further starts, several objectives, the analysis of the result.
    conditions : {"mean", "worst"}, optional
        What is minimised over the study's states and weathers, in place of the score as drawn.
    objective : {"entropy", "expected_ap"}
        What is improved: the study's entropy, or the expected AP of objects in traffic.
    """

    free: Annotated[Mapping[str, tuple[str, ...]], Part(stored=False)] = field(default_factory=dict)
    limits: Annotated[Mapping[str, Mapping[str, tuple[float, float]]], Part(stored=False)] = field(
        default_factory=dict
    )
    seed: int = setting(0, SEED, "The same seed finds the same placement", Panel("seed", "Seed"))
    samples: int = setting(
        DEFAULT_SEARCH_SAMPLES,
        SAMPLES_OR_GRID,
        "Voxels on which a candidate is evaluated; 0: all, 64 million",
        Panel("search_samples", "Search Voxels", beside="All"),
    )
    schedule: Annotated[Schedule, Part(inline=True)] = field(default_factory=Schedule)
    mounting: Annotated[Mounting, Part(inline=True)] = field(default_factory=Mounting)
    method: str = ""
    evaluations: int = setting(
        0,
        Whole(0, 1_000_000_000),
        "Most placements to evaluate; 0: the method's own number",
        Panel("evaluations", "Budget", soft_max=10_000, beside="All"),
    )
    tolerance: Tolerance = field(default_factory=Tolerance)
    grid: MountingGrid = field(default_factory=MountingGrid)
    goals: Annotated[Goals, Part(inline=True)] = field(default_factory=Goals)
    conditions: str | None = setting(
        None,
        OneOf(("mean", "worst")),
        "What a search minimizes where there are states or weathers",
        Panel(
            "search_conditions",
            "Search For",
            absent=("none", "As Drawn", "A search minimizes the score as drawn, in clear air"),
            menu=(
                ("Mean of Conditions", "A search minimizes the mean by weights"),
                ("Worst Condition", "A search minimizes the worst of the conditions"),
            ),
        ),
    )
    objective: str = setting(
        ENTROPY,
        OneOf(OBJECTIVES),
        "What a search improves: entropy, or expected AP of objects in traffic",
        Panel(
            "objective",
            "Objective",
            menu=(
                ("Entropy", "Lower the entropy of the targets: voxels or objects"),
                (
                    "Expected AP in Traffic",
                    "Raise the expected AP of objects that occlude each other",
                ),
            ),
        ),
    )

    def __post_init__(self) -> None:
        who = "optimize"
        object.__setattr__(self, "free", ReadOnlyDict(_each(self.free, "free", checked_axes)))
        object.__setattr__(
            self, "limits", ReadOnlyDict(_each(self.limits, "bounds", _checked_limits))
        )
        check_settings(self, who)
        for kind in (Schedule, Mounting, Tolerance, Goals):
            name = kind.__name__.lower()
            require_kind(who, name, getattr(self, name), kind)
        require_kind(who, "grid", self.grid, MountingGrid)
        known = checked_method(who, self.method or None, self.schedule != Schedule())
        object.__setattr__(self, "method", known)

    @property
    def from_each_start(self) -> int:
        """How many of `evaluations` each start has; 0: as many as the method takes."""
        share = round(self.evaluations / (1 + len(self.goals.starts)))
        return max(1, share) if self.evaluations else 0


@dataclass(frozen=True, eq=False)
class Study(Tabular):
    """Space, prior, perception model, vehicle, rig, and how to search.

    `mesh` names the file the vehicle was read from (or is written to), `axes` is how that is to be
    taken, `faces` how its axes were taken, in words (empty: they are the ground frame's), and
    `mesh_notes` what of it is left out.
    `samples` is the number of voxels a score looks at, 0: all; `reference` says where the vehicle's
    axles are, for exports. Of `search`, what concerns the rig's sensors is kept; one that it does
    not name is free as in the paper. `selection` says which sensors it may have instead of those of
    `rig`, and what they cost. `targets` says what is evaluated, `requirements` what has to be met,
    `conditions` the states of the vehicle and the weathers that count, `returns` which beams of the
    rig's LiDARs return. `frames` are those that the entropy over frames is of, `confirmation` says
    when a track is confirmed, in `scenarios` of what moves. `edges` are those of the vehicle that
    have names of their own, beside those that `vehicle_edges` finds. `figures` are the key figures
    that a score shows: it computes no others, but those that have a limit.

    `InputError` when a field is not of its type, or the samples are too few.
    """

    rig: Rig
    vehicle: Vehicle | None = None
    space: PerceptionSpace = field(default_factory=PerceptionSpace)
    prior: Prior = field(default_factory=Prior.road)
    model: PerceptionModel = field(default_factory=PerceptionModel)
    search: Search = field(default_factory=Search)
    samples: int = setting(
        0,
        SAMPLES_OR_GRID,
        "Voxels on which a score is evaluated; 0: all, 64 million",
        Panel("score_samples", "Score Voxels", default=FIRST_SAMPLES, beside="All"),
        scored=True,
    )
    mesh: str | None = None
    axes: MeshAxes = field(default_factory=MeshAxes)
    faces: str = ""
    mesh_notes: tuple[str, ...] = ()
    reference: Reference | None = None
    selection: Selection = field(default_factory=Selection)
    targets: TargetRule = field(default_factory=TargetRule)
    requirements: tuple[Requirement, ...] = ()
    conditions: Conditions = field(default_factory=Conditions)
    returns: str = setting(
        ALL,
        OneOf(RETURNS),
        "LiDAR beams that return: all (the paper), or as measured in real traffic",
        Panel(
            "returns",
            "LiDAR Returns",
            menu=(
                ("All Beams", "Each beam on a target returns, as in the paper"),
                ("As on the Road", "Bodies are open and returns fade, fitted to real traffic"),
            ),
        ),
        scored=True,
    )
    limits: Limits = field(default_factory=Limits)
    frames: Frames = field(default_factory=Frames)
    confirmation: Confirmation = field(default_factory=Confirmation)
    scenarios: tuple[Scenario, ...] = ()
    edges: tuple[Edge, ...] = ()
    figures: tuple[str, ...] = setting(
        tuple(SHOWN),
        Several(SHOWN),
        "Key figures that a score computes and shows; one with a limit is computed all the same",
        Panel(
            "figures",
            "Figures",
            menu=tuple((FIGURES[name].label, FIGURES[name].about) for name in SHOWN),
        ),
        scored=True,
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "requirements", checked_requirements(self.requirements))
        object.__setattr__(self, "scenarios", checked_scenarios(self.scenarios))
        object.__setattr__(self, "edges", checked_edges(self.edges))
        for name, kind in FIELDS.items():
            value = getattr(self, name)
            if value is not None or name not in OPTIONAL:
                require_kind("study", name, value, kind)
        if self.vehicle is not None:
            require_vehicle_size("vehicle", self.vehicle)
        if self.mesh is not None:
            object.__setattr__(self, "mesh", A_PATH.checked("study", "mesh", self.mesh))
        check_settings(self, "study")
        object.__setattr__(self, "rig", with_returns(self.rig, self.returns))
        self.conditions.check(self.vehicle, self.rig)
        object.__setattr__(self, "search", _of_rig(self.search, self.rig))

    def _caption(self) -> str:
        space = " x ".join(f"{high - low:g}" for low, high in (self.space.x, self.space.y))
        looked = f"{self.samples:,}" if self.samples else "all"
        return (
            f"{self.vehicle_line or 'no vehicle'}; {space} m, {self.prior.model}, {looked} voxels"
        )

    def _rows(self) -> list[dict[str, Any]]:
        free = self.search.free
        return [{**row, "free": ", ".join(free[row["sensor"]])} for row in self.rig._rows()]

    @property
    def vehicle_line(self) -> str | None:
        """The vehicle in one line: its file, its size, which way it faces; None without one."""
        if self.vehicle is None:
            return None
        return (
            f"{self.mesh or 'vehicle'}: {vehicle_line(self.vehicle, self.faces, self.mesh_notes)}"
        )

    @cached_property
    def vehicle_edges(self) -> VehicleEdges:
        """The edges of the vehicle by name: positions are told as distances from them."""
        return VehicleEdges(self.vehicle, self.edges, self.reference)

    @cached_property
    def shown_figures(self) -> tuple[str, ...]:
        """The names of the `figures` and of those with a limit, in the order of `FIGURES`."""
        return shown_figures(self.figures, self.limits)

    def distances(self, sensor: Sensor) -> tuple[str, ...]:
        """Return where a sensor is, from the edges that its position is told from: "0.35 m behind
        windshield top"."""
        found = self.vehicle_edges.distances(sensor.pose.position, sensor.measured_from)
        return tuple(each.text for each in found)

    def evaluator(
        self,
        samples: int | None = None,
        workers: int | None = None,
        on_objects: type[ObjectEvaluator] = ObjectEvaluator,
        shift: Shift = CENTERED,
    ) -> RigEvaluator:
        """Return the evaluator of this study; `samples` replaces the study's own.

        Objects stand in fewer scenes for a search's coarser levels, else in all of them;
        `on_objects` evaluates them. `shift` is that of `Evaluator`: a search has a sample of its
        own, `sampling.SEARCHED`.
        """
        samples = self.samples if samples is None else samples
        with self._naming_vehicle():
            if self.targets.are_objects:
                return on_objects(
                    self.space,
                    self.prior,
                    self.vehicle,
                    targets=replace(self.targets, scenes=self.scene_count(samples)),
                    model=self.model,
                    shift=shift[0],
                )
            return Evaluator(
                self.space,
                self.prior,
                self.vehicle,
                samples=samples,
                shift=shift,
                model=self.model,
                workers=workers,
            )

    def scene_count(self, samples: int) -> int:
        """Return the number of voxels (0: all) or scenes that a score with so many samples uses."""
        if not self.targets.are_objects:
            return samples
        share = samples / self.search.samples if 0 < samples < self.search.samples else 1.0
        scenes = self.targets.scenes
        if samples == self.samples:
            return scenes
        return max(min(scenes, FEW_SCENES), round(scenes * share))

    @property
    def level_samples(self) -> tuple[int, ...]:
        """Number of voxels of each level of the search, the coarsest first."""
        search = self.search
        sensors = len(self.coding().blocks)
        return METHODS[search.method].samples(search.samples, search.from_each_start, sensors)

    def sight(self, shift: Shift = CENTERED) -> Sight:
        """Return the `Sight` of this study: what its rigs see of the ground. `shift` is that of
        `evaluator`."""
        with self._naming_vehicle():
            return Sight(
                self.space,
                self.prior,
                self.vehicle,
                model=self.model,
                targets=self.targets,
                frames=self.frames,
                samples=self.samples,
                shift=shift,
            )

    def key_figures(self, known: KeyFigures | None = None) -> KeyFigures:
        """Return the key figures of this study's rig, with the margins of its scenarios.

        `known` are those without margins, where a score has them already.
        """
        margins = {scenario.name: self.drive_by(scenario).margin_s for scenario in self.scenarios}
        found = known
        if found is None:
            found = KeyFigures.of_rig(self.sight(), self.rig, self.shown_figures)
        return replace(found, margins=margins)

    def drive_by(self, scenario: Scenario, rig: Rig | None = None) -> DriveBy:
        """Return a scenario as a rig, the study's by default, sees it."""
        return drive_by(
            scenario,
            rig or self.rig,
            self.vehicle,
            self.model,
            confirmation=self.confirmation,
            rates=self.frames.rates,
        )

    def checker(self, as_drawn: RequirementChecker | None = None) -> RequirementChecker:
        """Return what holds rigs to the study's requirements.

        `as_drawn` is one of the same requirements round the same vehicle, if there is one already:
        what it has measured is not measured again.

        `InputError` when a zone cannot be placed round the vehicle, the rig lacks a kind of sensor,
        mounting errors are asked for that the study does not state, or nothing is known of a class.
        """
        wanted = self.requirements
        check_classes(wanted, self._known_classes())
        options: Any = {"model": self.model, "reference": self.reference, "space": self.space}
        if any(each.robust_to.states or each.robust_to.weathers for each in wanted):
            as_drawn = ConditionedChecker(
                self.requirements, self.vehicle, self.conditions, as_drawn, **options
            )
        checker = as_drawn or RequirementChecker(self.requirements, self.vehicle, **options)
        checker.check_rig(self.rig)
        for each in wanted:
            if each.robust_to.mounting and not self.search.tolerance.mounts_off:
                who = f"requirement {each.name!r}"
                raise InputError(who, "under.mounting", "errors in [optimize.tolerance]", "none")
        return checker

    def _known_classes(self) -> Iterator[str | None]:
        """Yield the classes of objects of which anything is known."""
        yield from self.prior.class_names
        yield from (each.name for each in (*ROAD_CLASSES, *HIGHWAY_CLASSES))
        yield from (body.class_name for body in BODIES.values())
        yield from (name for curves in self.model.objects.values() for name in curves)
        yield from (name for sensor in self.rig for name in getattr(sensor.model, "rcs", ()))

    def verdicts(
        self, rig: Rig | None = None, checker: RequirementChecker | None = None
    ) -> tuple[Verdict, ...]:
        """Return the verdicts on a rig, the study's by default, with its mounting errors."""
        steps = self.check_steps(checker, rig)
        return tuple(step.verdict for step in steps if step.verdict is not None)

    def check_steps(
        self,
        checker: RequirementChecker | None = None,
        rig: Rig | None = None,
        *,
        early: bool = False,
    ) -> Iterator[CheckStep]:
        """Yield the verdicts on a rig, the study's by default, one by one, with steps between.
        `early`: as of `RequirementChecker.steps`."""
        if not self.requirements:
            return
        rig = self.rig if rig is None else rig
        search = self.search
        cases = mounting_cases(self.requirements, rig, search.tolerance, search.seed)
        yield from (checker or self.checker()).steps(rig, cases=cases, early=early)

    def under(self, condition: StateInWeather) -> "Study":
        """Return the study under a condition, without conditions. What stands on the ground, such
        as the zones of its requirements, stays where the vehicle as drawn puts it."""
        rig, vehicle = condition(self.rig, self.vehicle)
        bare = [
            replace(each, robust_to=replace(each.robust_to, states=(), weathers=()))
            for each in self.requirements
        ]
        return replace(
            self, rig=rig, vehicle=vehicle, conditions=Conditions(), requirements=tuple(bare)
        )

    def with_unrelated_rig(self, rig: Rig) -> "Study":
        """Return the study of another rig, which is scored in the same way. What names the sensors,
        or the search, does not stay."""
        bare = replace(self, requirements=(), conditions=Conditions())
        return replace(bare, rig=rig, search=Search(), selection=Selection())

    @contextmanager
    def _naming_vehicle(self) -> Iterator[None]:
        """Add the vehicle to an error about a prior without weight outside the vehicle."""
        try:
            yield
        except InputError as error:
            if error.source != "prior" or self.vehicle_line is None:
                raise
            found = f"{error.found}; {self.vehicle_line}"
            raise InputError("prior", error.field, error.expected, found) from None

    def search_space(self) -> SearchSpace:
        """Return free axes and bounds [m or rad], with mounts and constraints."""
        search = self.search
        _check_pairs(self.rig, search.mounting)
        # Prices are of the designs, not of the sensors that they replace.
        limits = self.limits.changed(price=None) if self.selection.choices else self.limits
        return SearchSpace.on_vehicle(
            self.rig,
            self.vehicle,
            search.free,
            search.limits,
            mounting=search.mounting,
            housings=housings_of(self.rig),
            fixed=search.goals.fixed,
            figure_limits=limits,
        )

    def on_mounts(self) -> "Study":
        """Return the study with each sensor that is not on its mount at the nearest pose there.

        Sensors that follow others, mirror images and groups, follow. `InputError` where a mount
        cannot be.
        """
        return self.with_rig(rig_on_mounts(self.rig, self.search_space()))

    def search_run(self, journal: Sequence[Sequence[Any]] = ()) -> SearchRun:
        """Return the search of this study as a run that is asked and told: `SearchRun`."""
        search = self.search
        schedule = search.schedule if search.method == SCHEDULED_METHOD else None
        options: Any = {"method": search.method, "evaluations": search.evaluations}
        return SearchRun(
            self.rig, self.search_space(), search.seed, schedule, **options, journal=journal
        )

    def coding(self) -> Parametrization:
        """Return the unknowns of the search; `InputError` when it cannot be made."""
        self.search.tolerance.checked(self.rig)
        return Parametrization(self.rig, self.search_space())

    def designs(self) -> DesignSpace:
        """Return the designs to choose from; `InputError` where there is none."""
        return DesignSpace.of(self.selection, self.rig, self.search.mounting, self.limits)

    def with_rig(self, rig: Rig) -> "Study":
        """Return the study with other placements."""
        return replace(self, rig=rig)

    def with_mesh(self, mesh: str) -> "Study":
        """Return the study with the file named that has the vehicle's mesh as it is here."""
        return replace(self, mesh=mesh, axes=MeshAxes(), faces="", mesh_notes=())


FIELDS: dict[str, type] = {"rig": Rig, "space": PerceptionSpace, "prior": Prior, "search": Search}
FIELDS |= {"model": PerceptionModel, "axes": MeshAxes, "selection": Selection}
FIELDS |= {"targets": TargetRule, "vehicle": Vehicle, "reference": Reference}
FIELDS |= {"conditions": Conditions, "limits": Limits}
FIELDS |= {"frames": Frames, "confirmation": Confirmation}


def _each(table: Any, field: str, check: Callable[[str, str, Any], Any]) -> dict[str, Any]:
    """Return a mapping by sensor with each value checked."""
    if not isinstance(table, Mapping):
        raise InputError("optimize", field, "a mapping of sensors' names", shown(table))
    names = [A_NAME.checked("optimize", field, name) for name in table]
    return {name: check(f"sensor {name!r}", field, table[name]) for name in names}


def _checked_limits(source: str, field: str, limits: Any) -> dict[str, tuple[float, float]]:
    if not isinstance(limits, Mapping):
        raise InputError(source, field, "a mapping of axes to bounds", shown(limits))
    checked = {axis: checked_bounds(source, axis, bounds) for axis, bounds in limits.items()}
    return {axis: checked[axis] for axis in AXES if axis in checked}


def _of_rig(search: Search, rig: Rig) -> Search:
    """Return the search with an entry for each of the rig's sensors, in its order."""
    names = [sensor.name for sensor in rig]
    free = {name: search.free.get(name, PAPER_FREE) for name in names}
    limits = {name: own for name in names if (own := search.limits.get(name))}
    on = {name: search.mounting.on[name] for name in names if name in search.mounting.on}
    mounting = replace(search.mounting, on=on)
    goals = search.goals.of_rig(rig, mounting)
    return replace(search, free=free, limits=limits, mounting=mounting, goals=goals)


def _check_pairs(rig: Rig, mounting: Mounting) -> None:
    """Refuse a pair whose sensors are of different models."""
    models = {sensor.name: sensor.model for sensor in rig}
    for pair in mounting.pairs:
        one, other = (models.get(name) for name in pair)
        if one is not None and other is not None and not catalog.same_model(one, other):
            named = " and ".join(repr(name) for name in pair)
            found = f"{one.name} and {other.name}"
            raise InputError("optimize", f"pair of {named}", "sensors of one model", found)

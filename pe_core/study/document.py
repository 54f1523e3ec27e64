"""The study file as a tree of dataclasses: each field is a key (`base.codec` reads and writes it).

A `Document` differs from a `Study` where the file does: the axes that a sensor may change, its
bounds and its mount stand in the sensor's table, and the vehicle is a mesh file with its settings.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Annotated, Any

from ..base.codec import Node, hook, read_fields, write_fields
from ..base.errors import InputError
from ..base.plugins import shipped
from ..base.setting import NotStored, Pair, Part, Several, key_of, same_setting, settings_of
from ..base.values import A_NAME, A_PATH, listed
from ..geometry.grids import PerceptionSpace
from ..geometry.poses import METRES, ROTATION
from ..metric.frames import Frames
from ..motion import Confirmation, Scenario
from ..prior.prior import Prior
from ..scene.mesh import MeshAxes, require_vehicle_size
from ..scene.rig import POSITION_AXES, Rig, Sensor
from ..scene.vehicle import Vehicle
from ..scene.vehicle_description import Reference
from ..scoring.requirements import Requirement
from ..scoring.targets import TargetRule
from ..search import AXES, PAPER_FREE, SCHEDULED_METHOD, Limits, Schedule, Selection
from ..sensors import PerceptionModel
from .conditions import Conditions
from .file_names import MESH
from .requirement_file import read_requirement, write_requirement
from .scoring_file import FusionTable, ModelFile
from .study import Search, Study
from .vehicle_edges import POSITION, Distance, Edge, MetresOrDistance, VehicleEdges, checked_edges

Range = tuple[float, float]
FREE = Several(AXES)
ALONG = Pair(METRES, same=True)
ABOUT = Pair(ROTATION, same=True)


@dataclass(frozen=True)
class AxisBounds:
    """Bounds of a sensor's axes, in place of the default ones [m or rad]."""

    x: Annotated[Range | None, Part(rule=ALONG)] = None
    y: Annotated[Range | None, Part(rule=ALONG)] = None
    z: Annotated[Range | None, Part(rule=ALONG)] = None
    roll: Annotated[Range | None, Part(rule=ABOUT)] = None
    pitch: Annotated[Range | None, Part(rule=ABOUT)] = None
    yaw: Annotated[Range | None, Part(rule=ABOUT)] = None

    @property
    def by_axis(self) -> dict[str, Range]:
        """The bounds that are given, by axis."""
        own = {axis: getattr(self, axis) for axis in AXES}
        return {axis: bounds for axis, bounds in own.items() if bounds is not None}


@dataclass(frozen=True)
class SensorTable:
    """A table [[sensor]]: the sensor, the axes a search may change, their bounds, its mount; its
    position where that is told by distances from edges of the vehicle."""

    sensor: Annotated[Sensor, Part(inline=True)]
    free: Annotated[tuple[str, ...] | None, Part(rule=FREE)] = None
    bounds: AxisBounds = field(default_factory=AxisBounds)
    mount: Annotated[str | None, Part(rule=A_NAME)] = None
    coordinates: Annotated[tuple[MetresOrDistance, ...], NotStored] = ()

    def placed(self, edges: VehicleEdges) -> Sensor:
        """Return the sensor where its coordinates put it; `InputError` where there is no such
        edge."""
        if not self.coordinates:
            return self.sensor
        distances = [each for each in self.coordinates if isinstance(each, Distance)]
        pose = replace(self.sensor.pose, position=edges.position(self.coordinates))
        names = {each.axis: each.edge for each in distances}
        return replace(self.sensor, pose=pose, measured_from=names)


@dataclass(frozen=True)
class SensorForm(SensorTable):
    """The keys of a table [[sensor]]: a coordinate may be a distance from an edge."""

    position: Annotated[tuple[float | str, ...], Part(rule=POSITION)] = ()


def _read_sensor(node: Node) -> SensorTable:
    own = node.table.get("position")
    items = listed(own, len(POSITION_AXES)) or []
    if not any(isinstance(each, str) for each in items):
        return read_fields(SensorTable, node)
    path = node.at("position").path
    coordinates = POSITION.checked(node.source, path, own)
    metres = [0.0 if isinstance(each, Distance) else each for each in coordinates]
    plain = node.with_value({**node.table, "position": metres}, node.path)
    return replace(read_fields(SensorTable, plain), coordinates=coordinates)


def _write_sensor(table: SensorTable) -> dict[str, Any]:
    data = write_fields(table)
    if any(isinstance(each, Distance) for each in table.coordinates):
        data["position"] = [e.text if isinstance(e, Distance) else e for e in table.coordinates]
    return data


hook(SensorTable, _read_sensor, _write_sensor, SensorForm)
hook(Requirement, read_requirement, write_requirement, Requirement)


@dataclass(frozen=True)
class VehicleTable:
    """The table [vehicle]: the file of its mesh, how that is to be taken, and its settings."""

    mesh: Annotated[str | None, Part(rule=A_PATH)] = None
    glass: tuple[str, ...] = ()
    covers: Mapping[str, float] = field(default_factory=dict)
    clearance: float = same_setting(Vehicle, "clearance")
    axes: Annotated[MeshAxes, Part(inline=True)] = field(default_factory=MeshAxes)
    edge: tuple[Edge, ...] = ()

    def read(self, node: Node) -> dict[str, Any]:
        """Return the fields of a study with the vehicle, whose mesh is read."""
        if self.mesh is None and node.table:
            raise node.error("the file of the vehicle's mesh", "nothing", "mesh")
        if self.mesh is None:
            return {}
        mesh = shipped("reader.mesh")(node.folder / self.mesh, self.axes)
        require_vehicle_size(self.mesh, mesh)
        with node.naming():
            vehicle = Vehicle(
                triangles=mesh.triangles,
                parts=mesh.parts,
                part_names=mesh.part_names,
                glass=self.glass,
                clearance=self.clearance,
                covers=self.covers,
            )
        about = {"faces": mesh.axes, "mesh_notes": mesh.notes}
        return {"vehicle": vehicle, "mesh": self.mesh, "axes": self.axes, **about}

    @classmethod
    def of(cls, study: Study) -> "VehicleTable":
        """Return the table of a study's vehicle."""
        vehicle = study.vehicle
        if vehicle is None:
            return cls()
        return cls(
            mesh=study.mesh,
            glass=tuple(vehicle.glass),
            covers=vehicle.covers,
            clearance=vehicle.clearance,
            axes=study.axes,
            edge=study.edges,
        )


@dataclass(frozen=True)
class MeasurementTable:
    """The table [measurement]."""

    returns: str = same_setting(Study, "returns")


@dataclass(frozen=True)
class TimeTable:
    """The table [time]: frames of the entropy over frames, and how tracks are confirmed."""

    frames: Annotated[Frames, Part(inline=True)] = field(default_factory=Frames)
    confirmation: Annotated[Confirmation, Part(inline=True)] = field(default_factory=Confirmation)


@dataclass(frozen=True)
class Optimize:
    """The table [optimize]: the search; `free` are the axes of sensors that name none."""

    free: Annotated[tuple[str, ...], Part(rule=FREE)] = PAPER_FREE
    search: Annotated[Search, Part(inline=True)] = field(default_factory=Search)


@dataclass(frozen=True)
class Document:
    """A study file."""

    samples: int = same_setting(Study, "samples")
    figures: tuple[str, ...] = same_setting(Study, "figures")
    space: PerceptionSpace = field(default_factory=PerceptionSpace)
    prior: Prior = field(default_factory=Prior.road)
    targets: Annotated[TargetRule, Part(key="metric")] = field(default_factory=TargetRule)
    measurement: MeasurementTable = field(default_factory=MeasurementTable)
    ap: ModelFile = field(default_factory=ModelFile)
    fusion: FusionTable = field(default_factory=FusionTable)
    vehicle: VehicleTable = field(default_factory=VehicleTable)
    reference: Reference | None = None
    sensor: tuple[SensorTable, ...] = ()
    requirements: Annotated[tuple[Requirement, ...], Part(key="requirement", changes=True)] = ()
    conditions: Annotated[Conditions, Part(inline=True)] = field(default_factory=Conditions)
    time: TimeTable = field(default_factory=TimeTable)
    scenarios: Annotated[tuple[Scenario, ...], Part(key="scenario", changes=True)] = ()
    limits: Limits = field(default_factory=Limits)
    optimize: Optimize = field(default_factory=Optimize)
    selection: Selection = field(default_factory=Selection)

    @classmethod
    def of(cls, study: Study) -> "Document":
        """Return the document of a study."""
        return cls(
            measurement=MeasurementTable(study.returns),
            ap=ModelFile.of(study.model),
            fusion=FusionTable(study.model.blind),
            vehicle=VehicleTable.of(study),
            sensor=tuple(_sensor_table(sensor, study) for sensor in study.rig),
            time=TimeTable(study.frames, study.confirmation),
            optimize=Optimize(search=study.search),
            **{name: getattr(study, name) for name in IN_BOTH},
        )

    @property
    def perception(self) -> PerceptionModel:
        """The AP curves, and how sensors that see nothing count."""
        curves: Any = self.ap.curves
        return PerceptionModel(
            self.fusion.blind, objects=self.ap.objects, model=self.ap.model, **curves
        )

    def study(self, node: Node, vehicle: Vehicle | None = None) -> Study:
        """Return the study of the document that was read from a node; a `vehicle` takes the place
        of the file's, and has the name of a study's mesh."""
        self._check(node)
        own: dict[str, Any] = {"vehicle": vehicle, "mesh": MESH}
        if vehicle is None:
            own = self.vehicle.read(node.at("vehicle", {}))
        with node.at("vehicle", {}).naming():
            stated = checked_edges(self.vehicle.edge)
        edges = VehicleEdges(own.get("vehicle"), stated, self.reference)
        shared: dict[str, Any] = {name: getattr(self, name) for name in IN_BOTH}
        return Study(
            rig=Rig(list(self._placed(edges, node))),
            edges=stated,
            model=self.perception,
            search=self._search(node),
            returns=self.measurement.returns,
            frames=self.time.frames,
            confirmation=self.time.confirmation,
            **shared,
            **own,
        )

    def _placed(self, edges: VehicleEdges, node: Node) -> Iterator[Sensor]:
        """Yield the sensors where they are; `InputError` with the key of a position that none is
        at."""
        for number, row in enumerate(self.sensor):
            try:
                yield row.placed(edges)
            except InputError as error:
                key = f"sensor[{number}].position"
                if error.field:
                    key = f"{key}[{POSITION_AXES.index(error.field)}]"
                raise node.error(error.expected, error.found, key) from None

    def _search(self, node: Node) -> Search:
        """Return the search with what the tables of sensors say of it."""
        search = self.optimize.search
        rows = self.sensor
        usual = self.optimize.free
        free = {row.sensor.name: usual if row.free is None else row.free for row in rows}
        limits = {row.sensor.name: row.bounds.by_axis for row in rows}
        on = {row.sensor.name: row.mount for row in rows if row.mount is not None}
        for number, row in enumerate(rows):
            if row.mount is not None and row.mount not in search.mounting.mounts:
                names = search.mounting.mounts
                with node.with_value(None, f"sensor[{number}]").naming():
                    replace(search.mounting, mounts=names, on={row.sensor.name: row.mount})
        return replace(search, free=free, limits=limits, mounting=replace(search.mounting, on=on))

    def _check(self, node: Node) -> None:
        """Raise `InputError` for what no class of the document can see."""
        if not self.sensor:
            raise node.error("at least one [[sensor]]", "none", "sensor")
        search = self.optimize.search
        if search.method != SCHEDULED_METHOD and not self.selection.choices:
            for name in settings_of(Schedule):
                if getattr(search.schedule, name) != getattr(Schedule(), name):
                    expected = f'method = "{SCHEDULED_METHOD}", the only method with this key'
                    found = f'method = "{search.method}"'
                    raise node.error(expected, found, f"optimize.{key_of(name)}")


IN_BOTH = ({e.name for e in fields(Document)} & {e.name for e in fields(Study)}) - {"vehicle"}
"""Fields of a document that a study has as they are."""


def _sensor_table(sensor: Sensor, study: Study) -> SensorTable:
    search = study.search
    own = sensor.measured_from
    position = sensor.pose.position
    coordinates = study.vehicle_edges.coordinates(position, own) if own else ()
    free = search.free.get(sensor.name, PAPER_FREE)
    return SensorTable(
        sensor,
        free=None if free == PAPER_FREE else free,
        bounds=AxisBounds(**search.limits.get(sensor.name, {})),
        mount=search.mounting.on.get(sensor.name),
        coordinates=coordinates,
    )

"""The parametrization of a rig: a vector of design variables, and the rig that it stands for.

This is the only module that maps vectors to rigs: a search samples a vector, `candidate` turns it
into a placement, and `allowed` checks the placement against the rules. `feasible_start` finds a
placement that breaks no rule.

Linked sensors, mirror images and groups that move as one, have the variables of the first of them.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.errors import InputError, require_name, shown
from ..geometry.poses import Pose, rotate, rpy_from_matrix
from ..scene.rig import Rig, Sensor
from ..scene.vehicle import Vehicle
from .domains import (
    AXES,
    BoxDomain,
    DesignVariable,
    Domain,
    MountSurface,
    SlotDomain,
    SurfaceDomain,
    is_same_pose,
    pose_from_values,
    pose_text,
    rounded,
    snap_to_mount,
)
from .mounts import Mounting, SlotMount, SurfaceMount
from .search_space import Rule, SearchSpace, rules_of

MAX_ASYMMETRY = 0.05
"""A body is not symmetric if the distances of its sides from y = 0 differ by more than this share
of its width."""
Vector = tuple[float, ...]
MAX_TRIES = 2000
"""Placements checked before the rules are said to exclude all; nearest to the start first."""
MAX_NAMED = 4  # How many rules the message names


@dataclass(frozen=True, slots=True)
class Follower:
    """A sensor whose pose is determined by that of another sensor, its leader. `relative` is its
    rotation (3, 3) and position (3,) [m] in the leader's frame; None: it is the leader's mirror
    image across y = 0."""

    name: str
    leader: str
    relative: tuple[np.ndarray, np.ndarray] | None = None

    def pose(self, leader: Pose) -> Pose:
        """Return the follower's pose, rounded."""
        if self.relative is None:
            return mirrored(leader)
        turn, offset = self.relative
        rotation = leader.ground_from_sensor
        position = np.array(leader.position) + rotate(rotation, offset)
        rpy = rpy_from_matrix(rotate(rotation, turn.T).T)
        values = zip(AXES, (*position.tolist(), *rpy), strict=True)
        return pose_from_values(dict(values))


def mirrored(pose: Pose) -> Pose:
    """Return the mirror image of a pose across y = 0, rounded."""
    x, y, z = pose.position
    roll, pitch, yaw = pose.rpy
    return rounded(Pose((x, -y, z), (-roll, pitch, -yaw)))


def followers(rig: Rig, mounting: Mounting, vehicle: Vehicle | None) -> tuple[Follower, ...]:
    """Return the sensors that follow others, each after its leader. `InputError` when a sensor does
    not exist, follows two others or follows itself through others, a pair does not start as mirror
    images, or the vehicle is not symmetric."""
    _check_names(rig, mounting)
    waiting = {link.name: link for link in _links(rig, mounting)}
    if mounting.pairs and vehicle is not None:
        low, high = (float(corner[1]) for corner in vehicle.bounds)
        if abs(low + high) > MAX_ASYMMETRY * (high - low):
            expected = "a vehicle that is its own mirror image across y = 0"
            found = f"one from y = {low:.2f} to {high:.2f} m"
            raise InputError("optimize", "pairs", expected, found)
    ordered: list[Follower] = []
    while waiting:
        ready = [link for link in waiting.values() if link.leader not in waiting]
        if not ready:
            raise InputError(
                "optimize", "pairs, groups", "a sensor that leads", "a ring of sensors"
            )
        ordered += ready
        waiting = {name: link for name, link in waiting.items() if link not in ready}
    return tuple(ordered)


def _links(rig: Rig, mounting: Mounting) -> Iterator[Follower]:
    for first, second in mounting.pairs:
        image = mirrored(rig[first].pose)
        pose = rig[second].pose
        if not is_same_pose(image, pose):
            expected = f"the mirror image of {first!r} across y = 0, {pose_text(image)}"
            raise InputError(f"sensor {second!r}", "position", expected, pose_text(pose))
        yield Follower(second, first)
    yield from _group_links(rig, mounting)


def _group_links(rig: Rig, mounting: Mounting) -> Iterator[Follower]:
    """Yield the followers of groups, each with its pose relative to its leader."""
    for leader, *follower_names in mounting.groups:
        leader_pose = rig[leader].pose
        leader_from_ground = leader_pose.ground_from_sensor.T
        for name in follower_names:
            pose = rig[name].pose
            turn = rotate(leader_from_ground, pose.ground_from_sensor.T).T
            offset = np.array(pose.position) - np.array(leader_pose.position)
            yield Follower(name, leader, (turn, rotate(leader_from_ground, offset)))


def _check_names(rig: Rig, mounting: Mounting) -> None:
    names = [sensor.name for sensor in rig]
    for field, links in (("pairs", mounting.pairs), ("groups", mounting.groups)):
        for name in (name for link in links for name in link):
            require_name("optimize", field, name, names)
    following = [pair[1] for pair in mounting.pairs]
    following += [name for group in mounting.groups for name in group[1:]]
    for name in following:
        if following.count(name) > 1:
            expected = "a sensor that follows one other"
            raise InputError("optimize", "pairs, groups", expected, f"{name!r} follows two")
        if name in mounting.on:
            expected = "no mount for a sensor that follows another"
            raise InputError(f"sensor {name!r}", "mount", expected, shown(mounting.on[name]))


def rig_on_mounts(rig: Rig, space: SearchSpace) -> Rig:
    """Return a rig whose sensors are on their mounts: one that is not takes the nearest pose there.
    Mirror images and groups follow their leaders. `InputError` as of `Parametrization`."""
    mounting = space.mounting
    surfaces = dict[SurfaceMount, MountSurface]()
    _check_names(rig, mounting)
    poses = {sensor.name: _pose_on_mount(sensor, space, surfaces) for sensor in rig}
    links = [Follower(second, first) for first, second in mounting.pairs]
    links += _group_links(rig, mounting)
    for _ in links:  # a leader may follow another
        for link in links:
            led = link.pose(poses[link.leader])
            if not is_same_pose(led, poses[link.name]):
                poses[link.name] = led
    return rig.with_poses([poses[sensor.name] for sensor in rig])


def _pose_on_mount(
    sensor: Sensor, space: SearchSpace, surfaces: dict[SurfaceMount, MountSurface]
) -> Pose:
    """Return a sensor's pose if it is on its mount or has none; else the nearest pose there."""
    mount = space.mounting.mount_of(sensor.name)
    if mount is None or sensor.name in space.fixed:
        return sensor.pose
    try:
        _domain(sensor, space, surfaces)
    except InputError as error:
        if error.field != "position":
            raise
        return snap_to_mount(sensor, mount, space.vehicle, space.housings.get(sensor.name))
    return sensor.pose


@dataclass(frozen=True, slots=True)
class Candidate:
    """A placement, and the vector that stands for it."""

    rig: Rig
    vector: Vector


class Parametrization:
    """The design variables of a search, and the rigs that vectors of them stand for.

    `variables` are in the rig's order of sensors; one that follows another has none. `positions`
    has the sensor and the axis ("slot" of a list) of each; `blocks` has the positions in the vector
    of each sensor's variables, `models` the names of their models.
    `start` is the rig as it is, `rules` what no placement may break.

    `InputError` when a sensor, a part or a mount does not exist, a start is outside its bounds or
    its mount, or a pair or a group is impossible.
    """

    variables: tuple[DesignVariable, ...]
    blocks: tuple[range, ...]
    models: tuple[str, ...]
    start: Candidate
    rules: tuple[Rule, ...]

    def __init__(
        self, rig: Rig, space: SearchSpace, surfaces: dict[SurfaceMount, MountSurface] | None = None
    ) -> None:
        self.space = space.checked(rig)
        self._followers = followers(rig, space.mounting, space.vehicle)
        following = {follower.name for follower in self._followers}
        known = {} if surfaces is None else surfaces
        free = (sensor for sensor in rig if sensor.name not in following)
        self._domains = {each.name: _domain(each, space, known) for each in free}
        self.variables = tuple(v for domain in self._domains.values() for v in domain.variables)
        self.blocks = tuple(_blocks(self._domains.values()))
        self.positions = [(n, axis) for n, domain in self._domains.items() for axis in domain.axes]
        moved = (name for name, domain in self._domains.items() if domain.variables)
        self.models = tuple(rig[name].model.name for name in moved)
        vector = tuple(value for domain in self._domains.values() for value in domain.start)
        self.start = Candidate(rig, vector)
        self.rules = rules_of(rig, space, self._moving(), self._clear(), domains=self._domains)

    def candidate(self, vector: Sequence[float]) -> Candidate:
        """Return the placement that a vector (N,) of values stands for. The vector of the candidate
        is the given one after rounding, and after projection onto a surface."""
        poses = dict[str, Pose]()
        values = list[float]()
        start = 0
        for name, domain in self._domains.items():
            count = len(domain.variables)
            poses[name], placed_values = domain.placed(vector[start : start + count])
            values += placed_values
            start += count
        for follower in self._followers:
            poses[follower.name] = follower.pose(poses[follower.leader])
        rig = self.start.rig
        return Candidate(rig.with_poses([poses[sensor.name] for sensor in rig]), tuple(values))

    def domain_of(self, name: str) -> Domain:
        """Return the poses that a sensor may take, which follows no other."""
        return self._domains[name]

    def allowed(self, rig: Rig) -> bool:
        """Whether a placement breaks no rule."""
        trial = self.space.placement(rig)
        return not any(rule.broken(trial) for rule in self.rules)

    def broken(self, rig: Rig) -> frozenset[str]:
        """Return the texts of all rules that a placement breaks."""
        trial = self.space.placement(rig)
        return frozenset(rule.text for rule in self.rules if rule.broken(trial))

    def _moving(self) -> set[str]:
        """Names of the sensors that the search moves."""
        return self._with_followers(
            {name for name, domain in self._domains.items() if domain.variables}
        )

    def _clear(self) -> set[str]:
        """Names of the sensors whose housings must be clear: always those on a surface."""
        if self.space.mounting.constraints.clear_housings:
            return {sensor.name for sensor in self.start.rig}
        return self._with_followers(
            {n for n, domain in self._domains.items() if isinstance(domain, SurfaceDomain)}
        )

    def _with_followers(self, names: set[str]) -> set[str]:
        """Return names of sensors, with the names of all their followers."""
        for follower in self._followers:
            names |= {follower.name} if follower.leader in names else set()
        return names


def _blocks(domains: Iterable[Domain]) -> Iterator[range]:
    """Yield the positions in the vector of each domain's variables, without empty domains."""
    start = 0
    for domain in domains:
        count = len(domain.variables)
        if count:
            yield range(start, start + count)
        start += count


def _domain(
    sensor: Sensor, space: SearchSpace, surfaces: dict[SurfaceMount, MountSurface]
) -> Domain:
    mounting = space.mounting
    name = sensor.name
    mount = mounting.mount_of(name)
    bounds = space.bounds.get(name, {})
    who = f"sensor {name!r}"
    if name in space.fixed:
        return BoxDomain(sensor.pose, {})
    if isinstance(mount, SlotMount):
        return SlotDomain(who, mount, sensor.pose)
    if isinstance(mount, SurfaceMount):
        surface = surface_of(mounting.on[name], mount, space.vehicle, surfaces)
        return SurfaceDomain(
            who, mount, surface, sensor.pose, housing=space.housings.get(name), bounds=bounds
        )
    return BoxDomain(sensor.pose, bounds)


def surface_of(
    name: str,
    mount: SurfaceMount,
    vehicle: Vehicle | None,
    surfaces: dict[SurfaceMount, MountSurface],
) -> MountSurface:
    """Return the surface of a mount, made once for all stand-offs; `surfaces` are of one vehicle.
    `InputError` as `MountSurface`."""
    key = replace(mount, standoff=0.0)
    if key not in surfaces:
        surfaces[key] = MountSurface(f"mount {name!r}", mount, vehicle)
    return surfaces[key]


def feasible_start(parametrization: Parametrization, seed: int = 0) -> Candidate:
    """Return the start; if it breaks a rule, a placement near it that breaks none. `InputError`
    when no such placement is found; the message names rules that exclude each other."""
    if parametrization.allowed(parametrization.start.rig):
        return parametrization.start
    broken_rules = [parametrization.broken(parametrization.start.rig)]
    for vector in _widening_samples(parametrization, seed):
        candidate = parametrization.candidate(vector)
        broken = parametrization.broken(candidate.rig)
        if not broken:
            return candidate
        broken_rules.append(broken)
    raise _excluded([rule.text for rule in parametrization.rules], broken_rules)


def _widening_samples(parametrization: Parametrization, seed: int) -> Iterator[list[float]]:
    """Yield random vectors round the start, from its neighbourhood to the full ranges."""
    rng = np.random.default_rng(seed)
    for number in range(MAX_TRIES if parametrization.variables else 0):
        share = (number + 1) / MAX_TRIES
        steps = rng.uniform(-1.0, 1.0, len(parametrization.variables)).tolist()
        values = zip(parametrization.variables, parametrization.start.vector, steps, strict=True)
        yield [u.clipped(v + share * (u.high - u.low) * step) for u, v, step in values]


def _excluded(rules: Sequence[str], broken_rules: Sequence[frozenset[str]]) -> InputError:
    """Return the error that names a smallest set of rules of which each placement breaks one."""
    smallest = [text for text in rules if any(text in broken for broken in broken_rules)]
    for text in list(smallest):
        fewer = [other for other in smallest if other != text]
        if all(broken & set(fewer) for broken in broken_rules):
            smallest = fewer
    names = " and ".join(smallest[:MAX_NAMED]) + (", ..." if len(smallest) > MAX_NAMED else "")
    problem = "leaves no feasible placement" if len(smallest) == 1 else "exclude each other"
    expected = "a placement that breaks no rule"
    found = f"none in {len(broken_rules)} tried"
    return InputError("optimize", f"{names} {problem}", expected, found)

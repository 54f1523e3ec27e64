"""Requirements: a zone, test bodies, a criterion, and what the criterion has to survive."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated

from ...base.errors import InputError, require_kind, shown
from ...base.notebook import ShortRepr
from ...base.setting import FLAG, NAMES, Named, Panel, Part, check_settings, setting, settings_of
from ...base.values import A_NAME, A_TEXT, SHARE, Number, Whole
from ...scene.rig import Rig
from ...sensors import KINDS, kind_named
from .bodies import Body
from .zones import Zone

COUNT = Whole(1, 1000)
MAX_REQUIREMENTS = 200
POSITIVE_SHARE = Number(0.0, 1.0, above=True)
AREA = Number(0.0, 1e6, unit="m2", noun="area")
OF_BODIES = ("sensors", "kinds", "points", "pixels", "share", "ap", "zone_share")
DISTANCE = Number(0.0, 100.0, unit="m", noun="length")


@dataclass(frozen=True)
class Criterion:
    """What has to be seen of a body at a sample of the zone; its fields say what they ask for.

    A sensor sees a body if it has at least `points` on it (kinds that count points) or `pixels` of
    it (other kinds), and at least the `share` of it is visible, of its height (bands of 0.1 m) and
    its width. Only the kinds `of` sensors count, all by default; with `share` only kinds
    whose rays end on bodies (`Kind.shows_parts`).

    `InputError` when a value is none, or keys of bodies are mixed with those of the ground.
    """

    sensors: int = setting(
        1,
        COUNT,
        "Minimum number of sensors that must see the body",
        Panel("sensors", "Sensors", soft_max=6),
    )
    kinds: int = setting(
        1, COUNT, "Minimum number of kinds among these sensors", Panel("kinds", "Kinds", soft_max=3)
    )
    of: tuple[str, ...] = setting(
        (), NAMES, "Only these kinds of sensors count; by default all", Panel("of", "Only Kinds")
    )
    points: int = setting(
        1, COUNT, "Fewest points with which a LiDAR sees a body", Panel("points", "Points")
    )
    pixels: float = setting(
        1.0,
        Number(1e-6, 1e9, unit="px"),
        "Fewest pixels with which a camera sees a body",
        Panel("pixels", "Pixels"),
    )
    share: float | None = setting(
        None,
        POSITIVE_SHARE,
        "At least this share of the body is visible",
        Panel("share", "Visible Share"),
    )
    ap: float | None = setting(
        None, SHARE, "AP of the body's class is at least this, all sensors fused", Panel("ap", "AP")
    )
    zone_share: float = setting(
        1.0,
        POSITIVE_SHARE,
        "For at least this share of the zone's samples",
        Panel("zone_share", "Share of Zone"),
    )
    blind_m2: float | None = setting(
        None, AREA, "Largest area of blind ground in the zone", Panel("blind_m2", "Blind Area")
    )
    max_blind_distance: float | None = setting(
        None,
        DISTANCE,
        "Blind ground in the zone is at most this far from the vehicle",
        Panel("max_blind_distance", "Max Blind Distance"),
    )
    blind_height: float = setting(
        0.0,
        DISTANCE,
        "Height of the object that defines blind ground",
        Panel("blind_height", "Height"),
    )

    def __post_init__(self) -> None:
        check_settings(self, "criterion")
        for kind in self.of:
            kind_named(kind, "criterion", "of")
        changed = [k for k in OF_BODIES if getattr(self, k) != settings_of(Criterion)[k].default]
        if self.is_of_ground and changed:
            expected = "no key of bodies: blind_m2 and max_blind_distance are of ground"
            raise InputError("criterion", changed[0], expected, getattr(self, changed[0]))
        if self.kinds > self.sensors:
            object.__setattr__(self, "sensors", self.kinds)

    @property
    def is_of_ground(self) -> bool:
        """Whether the criterion is on blind ground, not on test bodies."""
        return self.blind_m2 is not None or self.max_blind_distance is not None

    def counts(self, kind: str) -> bool:
        """Whether sensors of a kind can meet the criterion."""
        if self.of and kind not in self.of:
            return False
        own = kind_named(kind, "criterion", "of")
        if self.is_of_ground:
            return own.lowest_m <= self.blind_height
        return own.shows_parts or self.share is None

    def check_rig(self, rig: Rig, who: str) -> None:
        """Raise `InputError` where the rig has not the kinds that are asked for."""
        kinds = {sensor.kind for sensor in rig}
        eligible = kinds & set(self.of) if self.of else kinds
        if not eligible:
            expected = f"a kind of sensor that the rig has ({', '.join(sorted(kinds))})"
            raise InputError(who, "criterion.of", expected, ", ".join(self.of))
        alone = ", ".join(sorted(eligible))
        eligible = set(filter(self.counts, eligible))
        if not eligible and self.is_of_ground:
            expected = f"a sensor that sees what is {self.blind_height:g} m tall on the ground"
            raise InputError(who, "criterion.blind_height", expected, f"{alone} alone")
        if not eligible:
            showing = ", ".join(name for name, kind in KINDS.items() if kind.shows_parts)
            expected = f"a sensor whose rays end on bodies ({showing})"
            raise InputError(who, "criterion.share", expected, f"{alone} alone")
        count = len(eligible)
        if self.kinds > count:
            expected = f"at most {count}, the number of kinds of the rig"
            raise InputError(who, "criterion.kinds", expected, self.kinds)


@dataclass(frozen=True)
class RobustTo:
    """What a requirement has to be robust to, beyond the rig as it stands. `states` and `weathers`
    are those of the study, by name; "*": all."""

    one_lost: bool = setting(
        False, FLAG, "Met without any one of the sensors, too", Panel("one_lost", "One Sensor Lost")
    )
    mounting: bool = setting(
        False,
        FLAG,
        "Met with the mounting errors of the search, too",
        Panel("mounting", "Mounting Errors"),
    )
    states: tuple[str, ...] = setting(
        (), NAMES, "Met in these states of the vehicle, too (*: in all)", Panel("states", "States")
    )
    weathers: tuple[str, ...] = setting(
        (), NAMES, "Met in these weathers, too (*: in all)", Panel("weathers", "Weathers")
    )

    def __post_init__(self) -> None:
        check_settings(self, "robust_to")


@dataclass(frozen=True)
class Requirement(ShortRepr):
    """A requirement: bodies at all samples of a zone meet a criterion.

    `InputError` when a value is none, there is no body, or a body has no class whose AP is asked
    for.

    `name`: Unique in a study.
    `bodies`: Each of them has to meet the criterion, one at a time.
    `preset`: Identifier of the preset that it was made from.
    `source`: Where its figures are from.
    `check`: What it is called in a verdict: "R159 Annex 3".
    `original`: The preset as it is shipped; it tells whether this requirement is changed.
    """

    name: Named
    zone: Zone
    bodies: Annotated[tuple[Body, ...], Part(key="body")] = ()
    criterion: Criterion = field(default_factory=Criterion)
    robust_to: RobustTo = field(default_factory=RobustTo)
    preset: str | None = None
    source: str = ""
    check: str = ""
    original: Annotated["Requirement | None", Part(stored=False)] = field(
        default=None, compare=False, repr=False
    )

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "name", A_NAME.checked("requirement", "name", self.name))
        who = f"requirement {self.name!r}"
        put(self, "bodies", tuple(self.bodies))
        for key, kind in (("zone", Zone), ("criterion", Criterion), ("robust_to", RobustTo)):
            require_kind(who, key, getattr(self, key), kind)
        for key in ("source", "check"):
            if getattr(self, key):
                A_TEXT.checked(who, key, getattr(self, key))
        if not self.bodies and not self.criterion.is_of_ground:
            raise InputError(who, "body", "a test body", "none")
        for body in self.bodies:
            self._check_body(body, who)

    @property
    def is_changed(self) -> bool:
        """Whether it asks for something else than its preset. The driver's eyes and the side of the
        kerb are the vehicle's, and change no preset."""
        own = self.original
        if own is None:
            return False
        zone = replace(self.zone, eyes=own.zone.eyes, near_side=own.zone.near_side)
        wanted = zone, self.bodies, self.criterion, self.robust_to
        return wanted != (own.zone, own.bodies, own.criterion, own.robust_to)

    @property
    def after(self) -> str:
        """What a verdict is called after: "UN R158"; of a changed preset "UN R158, changed"."""
        named = self.original is not None and self.check == self.original.check
        return f"{self.check}, changed" if named and self.check and self.is_changed else self.check

    def _check_body(self, body: Body, who: str) -> None:
        if self.criterion.ap is not None and body.class_name is None:
            raise InputError(who, "criterion.ap", f"a class of {body.name!r}", "none")
        zone = self.zone
        if zone.ring is not None and zone.ring[1] - zone.ring[0] < min(body.size[:2]) / 2.0:
            found = f"{body.name}, {min(body.size[:2]):g} m wide, in a ring of {zone.ring} m"
            raise InputError(who, "body", "a body that is not larger than the zone", found)


def checked_requirements(requirements: Sequence[Requirement]) -> tuple[Requirement, ...]:
    """Return requirements; raise `InputError` for two of one name, or what is none."""
    names: set[str] = set()
    if len(requirements) > MAX_REQUIREMENTS:
        expected = f"at most {MAX_REQUIREMENTS} requirements"
        raise InputError("study", "requirement", expected, len(requirements))
    for each in requirements:
        if not isinstance(each, Requirement):
            raise InputError("study", "requirements", "requirements", shown(each))
        if each.name in names:
            raise InputError("study", "requirement", "each name once", f"{each.name!r} twice")
        names.add(each.name)
    return tuple(requirements)


def levels_of(requirement: Requirement) -> int:
    """Return the number of heights at which bodies stand at each sample."""
    low, high = requirement.zone.z
    return 1 if high == low else math.ceil((high - low) / requirement.zone.step) + 1

"""Sites: the sensors of a rig that take a model together, and what they may take."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..errors import InputError, shown
from ..scene.sensors import Rig
from .mounts import NO_MOUNT, Mounting
from .selection import Choice, Option, Selection


@dataclass(frozen=True, slots=True)
class Site:
    """Sensors that take one model, or are left out together.

    Attributes
    ----------
    sensors : tuple of str
    options : tuple of Option or None
        By price; None, last, leaves them out.
    alike : int
        Sites of one number may change what they take: that is the same design.
    """

    sensors: tuple[str, ...]
    options: tuple[Option | None, ...]
    alike: int

    def price(self, pick: int) -> float:
        """What an option costs for all sensors of the site."""
        option = self.options[pick]
        return 0.0 if option is None else option.price * len(self.sensors)


def sites_of(selection: Selection, rig: Rig, mounting: Mounting) -> tuple[Site, ...]:
    """Return the sites of a study, in the order of its choices.

    Raises
    ------
    InputError
        When a choice is of a sensor or a mount that is none, two are of one sensor, a model's kind
        is not allowed, or what others follow could be left out.
    """
    sites: list[Site] = []
    for number, choice in enumerate(selection.choices):
        _check_kinds(f"choice[{number}]", choice, selection)
        options = sorted(choice.options, key=lambda option: option.price)
        for sensors in _taken(f"choice[{number}]", choice, rig, mounting):
            for name in sensors:
                _check_sensor(f"choice[{number}]", name, sites, choice.optional, mounting)
            left_out = (None,) if choice.optional else ()
            sites.append(Site(sensors, (*options, *left_out), number))
    return tuple(sites)


def _taken(who: str, choice: Choice, rig: Rig, mounting: Mounting) -> Iterator[tuple[str, ...]]:
    """Yield the sensors of each site of a choice, with those that mirror them."""
    names = [sensor.name for sensor in rig]
    for name in choice.sensors:
        if name not in names:
            raise InputError(who, "sensor", f"one of {', '.join(names)}", shown(name))
    if choice.mount is None:
        yield _with_images(choice.sensors, mounting)
        return
    if choice.mount not in mounting.mounts:
        known = f"one of {', '.join(mounting.mounts)}" if mounting.mounts else NO_MOUNT
        raise InputError(who, "mount", known, shown(choice.mount))
    there = [name for name in names if mounting.on.get(name) == choice.mount]
    if not there:
        expected = "a mount with sensors on it"
        raise InputError(who, "mount", expected, f"none on {choice.mount!r}")
    yield from (_with_images((name,), mounting) for name in there)


def _with_images(names: Sequence[str], mounting: Mounting) -> tuple[str, ...]:
    """Return sensors with those that mirror them."""
    taken = list(names)
    for first, second in mounting.pairs:
        if second in taken and first not in taken:
            expected = f"the first of the pair, {first!r}, which it goes with"
            raise InputError("choice", "sensor", expected, shown(second))
        if first in taken and second not in taken:
            taken.append(second)
    return tuple(dict.fromkeys(taken))


def _check_sensor(
    who: str, name: str, before: list[Site], optional: bool, mounting: Mounting
) -> None:
    if any(name in site.sensors for site in before):
        raise InputError(who, "sensor", "one choice for each sensor", f"two for {name!r}")
    if optional and any(name == group[0] for group in mounting.groups):
        expected = "false for the sensor that leads a group"
        raise InputError(who, "optional", expected, f"true for {name!r}")


def _check_kinds(who: str, choice: Choice, selection: Selection) -> None:
    for option in choice.options:
        kind = option.model.kind
        if selection.max_of_kind.get(kind) == 0:
            expected = f"models of kinds that are allowed (max_of_kind of {kind!r} is 0)"
            raise InputError(who, "option", expected, f"{option.model.name}, a {kind}")

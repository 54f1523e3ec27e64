"""Weather: what rain, snow, fog and night leave of a sensor's range.

A weather is a function of a rig and a vehicle: each kind of sensor answers with its model as it is
under it (`Kind.in_weather`), by the formulas here. Nothing else knows of weather. A range under a
weather is rounded down to 1 cm.

Sources: [KO] Koschmieder's law with a contrast threshold of 5 %, extinction = ln 20 / MOR;
[LISA] Kilic et al., arXiv 2107.07004; [FOG] Hahner et al., Fog Simulation on Real LiDAR Point
Clouds, ICCV 2021, and the constants of MartinHahner/LiDAR_fog_sim@4278db1; [P838] ITU-R P.838-3;
[IIHS] Headlight Test and Rating Protocol II (2016); [R112] UN Regulation 112, class B.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from ..base.errors import InputError, shown
from ..base.setting import FLAG, Named, Panel, check_settings, setting
from ..base.values import A_NAME, WEIGHT, Number
from ..scene.rig import Rig, SensorModel
from ..scene.vehicle import Vehicle
from .field_of_view import LIGHT_M_S
from .kind import kind_of

RAIN = Number(0.0, 300.0, unit="mm/h")
SNOW = Number(0.0, 50.0, unit="mm/h")
WEIGHED = "Part in the weighted mean of all conditions"
MOR = Number(1.0, 1e5, unit="m", noun="length")
RAIN_KM = ((0.0, 0.0), (5.0, 1.00), (10.0, 1.56), (25.0, 2.77), (50.0, 4.29), (100.0, 6.64))
"""Rain [mm/h] and extinction of light [1/km]: drops of Marshall and Palmer, efficiency 2."""
SNOW_KM = ((0.0, 0.0), (1.0, 1.44), (2.5, 2.43), (5.0, 3.60))
"""Snow [mm/h of water] and extinction of light [1/km], in the same way."""
BACKSCATTER = 0.046  # Backscatter of fog times MOR [1/sr], [FOG]
TARGET_BACKSCATTER = 1e-6 / math.pi
PULSE_S = 2e-8
OVERLAP_M = (0.9, 1.0)
"""[FOG]: a target's differential reflectivity, half-power width of the pulse [s], and distances
[m] from which the receiver sees some of the beam, and all of it."""
CONTRAST = 0.5
THRESHOLD = 0.05
"""Contrast of an object against its background, and the least that is found, [KO]."""
LAMP_LUX = 12.0
LAMP_M = 25.0
LAMPS = 2
SEEN_LUX = 5.0
"""A headlamp's least illuminance at point 75R, its distance [R112], their number; the illuminance
to which lamps are said to reach [IIHS]."""


@dataclass(frozen=True, slots=True)
class Weather:
    """A weather, with a name that is unique in a study, and how much it counts.

    Its fields say what they mean. At most one of rain, snow and fog is given: a measured
    visibility, where a contrast has fallen to 5 %, holds all that is in the air. At night
    passive cameras see what the vehicle's headlamps light.
    Wet clothes have a reflectivity of 0.5.

    `InputError` when a value is out of its range, or two of rain, snow and fog are given.
    """

    name: Named
    weight: float = setting(1.0, WEIGHT, WEIGHED, Panel("weight", "Weight"), scored=True)
    rain_mm_h: float = setting(
        0.0, RAIN, "Rate of rain", Panel("rain_mm_h", "Rain mm/h"), scored=True
    )
    snow_mm_h: float = setting(
        0.0, SNOW, "Rate of snow, as water", Panel("snow_mm_h", "Snow mm/h"), scored=True
    )
    fog_mor_m: float | None = setting(
        None,
        MOR,
        "Visibility in fog: the meteorological optical range",
        Panel("fog_mor_m", "Visibility in Fog", zero="no fog"),
        scored=True,
    )
    night: bool = setting(
        False, FLAG, "Cameras see what headlamps light", Panel("night", "Night"), scored=True
    )
    reflectivity: float = setting(
        1.0,
        Number(0.0, 10.0, above=True),
        "Reflectivity of targets, relative to that for which sensors state their range",
        Panel("reflectivity", "Reflectivity", min=0.001),
        scored=True,
    )
    returns: str = ""
    """`Lidar.returns` under it; empty: as it is."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", A_NAME.checked("weather", "name", self.name))
        who = f"weather {self.name!r}"
        check_settings(self, who)
        given = {
            "rain_mm_h": self.rain_mm_h or None,
            "snow_mm_h": self.snow_mm_h or None,
            "fog_mor_m": self.fog_mor_m,
        }
        both = [f"{key} = {value:g}" for key, value in given.items() if value is not None]
        if len(both) > 1:
            expected = "one of rain, snow and visibility (fog_mor_m): it holds all in the air"
            raise InputError(who, both[1].split()[0], expected, " and ".join(both))

    def __call__(self, rig: Rig, vehicle: Vehicle | None = None) -> tuple[Rig, Vehicle | None]:
        """Return a rig with its sensors as they are under this weather, and the vehicle itself."""
        if self.is_clear:
            return rig, vehicle
        models = [self.model(sensor.model) for sensor in rig]
        pairs = zip(rig, models, strict=True)
        sensors = [s if model is s.model else replace(s, model=model) for s, model in pairs]
        return Rig(sensors), vehicle

    @property
    def extinction(self) -> float:
        """Extinction of visible and near infrared light [1/m]; in fog ln 20 / MOR, [KO]."""
        if self.fog_mor_m is not None:
            return math.log(20.0) / self.fog_mor_m
        return (_of_table(RAIN_KM, self.rain_mm_h) + _of_table(SNOW_KM, self.snow_mm_h)) / 1000.0

    @property
    def is_clear(self) -> bool:
        """Whether sensors are as they are without it."""
        as_in_clear_air = self.extinction == 0.0 and not self.night and self.reflectivity == 1.0
        return as_in_clear_air and not self.returns

    def model(self, model: SensorModel) -> SensorModel:
        """Return a model as it is under this weather."""
        return model if self.is_clear else _model_in_weather(model, self)


@lru_cache(maxsize=1024)
def _model_in_weather(model: SensorModel, weather: Weather) -> SensorModel:
    """Return one and the same object for a model and a weather: caches compare by identity."""
    changed: SensorModel = kind_of(model).in_weather(model, weather)
    return changed


def returning(model: SensorModel, returns: str) -> SensorModel:
    """Return a model with these returns; of a kind without any, or with these, the same object."""
    if getattr(model, "returns", returns) == returns:
        return model
    return Weather("returns", returns=returns).model(model)


def with_returns(rig: Rig, returns: str) -> Rig:
    """Return a rig whose LiDARs have these returns; the same rig where they do already."""
    sensors = [replace(each, model=returning(each.model, returns)) for each in rig]
    same = all(a.model is b.model for a, b in zip(rig, sensors, strict=True))
    return rig if same else Rig(sensors)


def lidar_range(max_range: float, weather: Weather) -> float:
    """Return the greatest range of a LiDAR under a weather [m].

    A pulse returns with ``P ~ rho exp(-2 alpha R) / R^2`` [LISA]; it is found while P is at least
    that from `max_range` in clear air: ``R^2 exp(2 alpha R) = R0^2``, ``R0 = max_range sqrt(rho)``
    at most `max_range`. In fog a beam is also lost where the fog's own return beats it.
    """
    start = max_range * min(1.0, math.sqrt(weather.reflectivity))
    alpha = weather.extinction
    found = _greatest(lambda r: math.log(r) + alpha * r <= math.log(start), start)
    if weather.fog_mor_m is None:
        return found
    return min(found, fog_return_range(weather.fog_mor_m, weather.reflectivity))


@lru_cache(maxsize=256)
def fog_return_range(mor: float, reflectivity: float = 1.0) -> float:
    """Return the range from which on fog's own return is stronger than that of a target [m].

    [FOG], equations 8 to 12: a target returns ``b0 exp(-2 alpha R) / R^2``, fog the greatest over
    R of ``b integral sin^2(pi t / 2 tau) xi(r) exp(-2 alpha r) / r^2 dt`` with ``r = R - c t / 2``,
    t from 0 to 2 tau, ``b = 0.046 / MOR``; xi rises from 0 to 1 between both `OVERLAP_M`.
    """
    alpha = math.log(20.0) / mor
    soft = BACKSCATTER / mor * max(_fog_integral(alpha, 0.5 + 0.1 * k) for k in range(80))
    level = math.log(TARGET_BACKSCATTER * reflectivity) - math.log(soft)
    return _greatest(lambda r: 2.0 * (math.log(r) + alpha * r) <= level, 1e5)


def _fog_integral(alpha: float, distance: float, steps: int = 600) -> float:
    """Return the integral of a pulse over fog that ends at a distance [s / m^2]."""
    step = 2.0 * PULSE_S / steps
    near, full = OVERLAP_M
    total = 0.0
    for k in range(steps):
        time = (k + 0.5) * step
        r = distance - LIGHT_M_S * time / 2.0
        if r <= near:
            break
        pulse = math.sin(math.pi * time / (2.0 * PULSE_S)) ** 2
        overlap = min(1.0, (r - near) / (full - near))
        total += pulse * overlap * math.exp(-2.0 * alpha * r) / (r * r)
    return total * step


def camera_range(max_range: float, weather: Weather) -> float:
    """Return the greatest range of a passive camera under a weather [m].

    Contrast falls as ``C = C0 exp(-alpha d)`` [KO]; an object is found while C is at least Ct:
    ``d = ln(C0 / Ct) / alpha``, 0.77 MOR. At night an object is found while its headlamps' light
    ``E (25 / d)^2 exp(-alpha d)`` is at least 5 lux: 54.7 m in clear air, ahead of the lamps; to
    other sides this is an upper bound.
    """
    alpha = weather.extinction
    found = max_range
    if alpha > 0.0:
        found = min(found, math.log(CONTRAST / THRESHOLD) / alpha)
    if weather.night:
        lit = LAMP_M * math.sqrt(LAMPS * LAMP_LUX / SEEN_LUX)
        log_lit = 2.0 * math.log(lit)
        found = min(found, _greatest(lambda d: 2.0 * math.log(d) + alpha * d <= log_lit, lit))
    return _down(found)


def rain_db_per_km(rain_mm_h: float, k: float = 1.132, exponent: float = 0.718) -> float:
    """Return the attenuation of a radar's wave one way, ``k R^a`` [dB/km]; 77 GHz, [P838]."""
    return k * rain_mm_h**exponent if rain_mm_h > 0.0 else 0.0


def _greatest(holds: Callable[[float], bool], high: float) -> float:
    """Return the greatest distance for which a falling condition holds, rounded down [m]."""
    if holds(high):
        return _down(high)
    low = 1e-6
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return _down(low)


def _down(length: float) -> float:
    """Return a length rounded down to 1 cm; a whole number of them stays [m]."""
    return length if math.isinf(length) else math.floor(length * 100.0 + 1e-6) / 100.0


def _of_table(table: Sequence[tuple[float, float]], rate: float) -> float:
    """Return an extinction [1/km] between rows, above the last by its power law."""
    for (low, start), (high, end) in itertools.pairwise(table):
        if rate <= high:
            return start + (end - start) * (rate - low) / (high - low)
    (low, start), (high, end) = table[-2:]
    power = math.log(end / start) / math.log(high / low)
    return float(end * (rate / high) ** power)


def checked_weights(source: str, items: Sequence[Any]) -> None:
    """Raise `InputError` where names repeat, or where all weights are 0."""
    names = [item.name for item in items]
    for number, name in enumerate(names):
        if name in names[:number]:
            raise InputError(source, "name", "each name once", f"{shown(name)} twice")
    if items and not any(item.weight > 0.0 for item in items):
        raise InputError(source, "weight", "at least one weight above 0", "0 everywhere")

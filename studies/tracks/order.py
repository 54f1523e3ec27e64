"""Published order of late frames, and of several frames, against eqs. T1, T2 and T5."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.metric.entropy import BLIND_PRECISION, sigma_of
from pe_core.metric.frames import Frames

from ..results_file import Json, read_json

TABLE = Path(__file__).with_name("published.json")
NOISES = (0.1, 1.0, 10.0)
COUNTS = (2, 5, 16)
SHOWN = 1.0, 5
NEAR = 0.25
HOLDS = "holds"
FAILS = "does not hold"


def over_frames(ap: Floats, frames: int, q: float) -> Floats:
    """Return the AP (N,) of some frames at 10 Hz, of which each has the AP (N,)."""
    known = Frames(frames=frames, q=q)
    precision = known.fused(["lidar"], [sigma_of(ap) ** -2.0 - BLIND_PRECISION], BLIND_PRECISION)
    return np.asarray(1.0 / (1.0 + precision**-0.5))


def statements() -> list[list[str]]:
    """Return a row for each statement of the plan: what was published, and the verdict."""
    found: Json = read_json(TABLE)
    late = found["late"]
    rings = found["rings"]["rows"]
    several = found["frames"]["rows"]
    share = np.array(late["share"])
    ratios = {}
    falls = []
    for name, values in late["rows"].items():
        lost = 1.0 - np.array(values) / values[0]
        falls.append(bool((np.diff(values) < 0.0).all()))
        ratios[name] = lost[2:] / lost[1]
    wanted = share[2:] / share[1]
    near = {n: bool((np.abs(r / wanted - 1.0) <= NEAR).all()) for n, r in ratios.items()}
    worst = max(ratios, key=lambda n: float(np.abs(ratios[n] / wanted - 1.0).max()))
    gains = {n: np.subtract(row["several"], row["one"]) for n, row in rings.items()}
    rising = [bool((np.diff(gain) > 0.0).all()) for gain in gains.values()]
    fsd = several["FSD"]
    a_frame = np.diff(fsd["ap"], axis=0) / np.diff(fsd["frames"])[:, None]
    less = (a_frame[1] < a_frame[0]).tolist()
    by_class = {n: np.subtract(row["ap"][-1], row["ap"][0]) for n, row in several.items()}
    alike = [
        np.argsort(gain).tolist() == np.argsort(-np.array(several[n]["ap"][0])).tolist()
        for n, gain in by_class.items()
    ]
    ratio = " and ".join(f"{r:.2f}" for r in ratios[worst])
    return [
        [
            "5. The more often late, the lower",
            f"{sum(falls)} of {len(falls)} detectors",
            _all(falls),
        ],
        [
            "6. Loss proportional to the share",
            f"{sum(near.values())} of {len(near)}; {worst} {ratio}, expected 2 and 3",
            _all(near.values()),
        ],
        ["7. Tracks gain more, the farther", "; ".join(map(_texts, gains.values())), _all(rising)],
        [
            "8. Further frames gain less",
            f"a frame {_texts(a_frame[0])}, then {_texts(a_frame[1])}",
            _all(less),
        ],
        [
            "9. The worst class gains most",
            "; ".join(f"{n} {_texts(gain)}" for n, gain in by_class.items()),
            _all(alike),
        ],
    ]


def expected() -> str:
    """Return what T1 and T2 say of the rings, at one noise and number of frames."""
    rows = read_json(TABLE)["rings"]["rows"]
    q, count = SHOWN
    ones = [np.array(row["one"]) for row in rows.values()]
    return "; ".join(_texts(over_frames(one, count, q) - one) for one in ones)


def follows() -> dict[str, bool]:
    """Return whether statements 7 to 9 follow from T1 and T2 at each noise and count."""
    found = read_json(TABLE)
    ones = [np.array(row["one"]) for row in found["rings"]["rows"].values()]
    ones += [np.sort(row["ap"][0])[::-1] for row in found["frames"]["rows"].values()]
    rising: list[bool] = []
    less: list[bool] = []
    for q in NOISES:
        for one in ones:
            ap = [one, *(over_frames(one, count, q) for count in COUNTS)]
            rising += [bool((np.diff(each - one) > 0.0).all()) for each in ap[1:]]
            steps = np.diff(ap, axis=0) / np.diff([1, *COUNTS])[:, None]
            less += [bool((b < a).all()) for a, b in pairwise(steps)]
    return {"7 and 9": all(rising), "8": all(less)}


def _all(each: Iterable[bool]) -> str:
    return HOLDS if all(each) else FAILS


def _texts(values: Floats) -> str:
    return ", ".join(f"{v:+.3f}" for v in values)

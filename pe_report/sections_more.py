"""The page's other sections: pitch, sensitivity, AP curve, priors, and how it was made."""

from __future__ import annotations

from .facts import Facts, table
from .paper import HOUR_S, PITCH_HEIGHT_M, ROW
from .plan import FITS, LIDAR_ROWS
from .settings import EXPECTED, SETTINGS


def pitch(facts: Facts) -> str:
    """Return the account of the pitch figure."""
    claim = facts.claim("pitch", "printed")
    curve = sorted((float(k), v["entropy"]) for k, v in facts.named("pitch/").items())
    lowest = min(curve, key=lambda pair: pair[1])
    return f"""
## The pitch figure

Two Pandar40 at the bus's front corners, both {PITCH_HEIGHT_M} m high, the first level, under `road` with
default weights. **The same as in the paper:** at equal pitch the channels of one cover those of the other,
which is the worst there is nearby ({claim["worse_entropy"]:.4f}); a small difference puts the beams of
one into the gaps of the other ({claim["better_entropy"]:.4f} at {claim["better"]}). The lowest of the
whole range is {lowest[1]:.4f} at {lowest[0]:g} deg. The pattern repeats every third of a degree, the
spacing of the Pandar40's dense channels. Each LiDAR alone hardly changes over so small an angle.

![Entropy against the pitch difference](pitch.png)
"""


def sensitivity(facts: Facts) -> str:
    """Return what experiment 1 depends on."""
    varied = facts.named("vary/")
    settings = [s for s in (*SETTINGS, EXPECTED) if f"{s}/{LIDAR_ROWS[0]}" in varied]
    lines = []
    for setting in settings:
        low, high = (varied[f"{setting}/{row}"] for row in LIDAR_ROWS)
        cells = [f"{v['entropy']:.4f}" for v in (low, high)]
        verdict = "holds" if low["entropy"] < high["entropy"] else "**does not hold**"
        lines.append([setting, *cells, f"{high['entropy'] - low['entropy']:.2f}", verdict])
    reverse = [line[0] for line in lines if "not" in line[-1]]
    always = "The ordering holds in all of them." if not reverse else ""
    titles = ["changed", ROW[LIDAR_ROWS[0]].label, ROW[LIDAR_ROWS[1]].label, "apart", "ordering"]
    return f"""
## What experiment 1 depends on

One thing changed at a time, at the printed placements, under `road`. {always}

{table(titles, lines)}

![Both LiDARs under each change](sensitivity.png)

The side of the voxels matters most: a larger cube meets more beams, and AP = a ln m + b was fitted for a
voxel of 0.1 m, so only that one has a meaning; the others tell how steep the dependence is. The prior's
scales come next: how far away objects are is worth up to 3 nats for the same LiDAR, so the paper's absolute
figures cannot be judged without its prior. The vehicle takes little from a LiDAR this far above the roof.
"No vehicle" also counts the voxels where the vehicle would be, which a LiDAR on its roof does not see.
"""


def ap_curve(facts: Facts) -> str:
    """Return fits of the AP curve."""
    lines = []
    for name in FITS:
        fit = facts[f"fit/{name}"]
        used = sum(not why for why in fit["left_out"])
        lines.append(
            [
                name.replace("_", " "),
                f"{fit['a']:.3f} ± {fit['a_error']:.3f}",
                f"{fit['b']:.3f} ± {fit['b_error']:.3f}",
                f"{used} of {len(fit['m'])}",
                f"{fit['rms']:.3f}",
            ]
        )
    titles = ["points", "a", "b", "points taken", "rms of AP"]
    return f"""
## The AP curve

The paper fits AP = 0.152 ln m + 0.659 to PointPillars on KITTI. Its points are not public. `pe fit` on
public detections of another LiDAR detector, PointRCNN, on KITTI tracking, by class; and on points
made from the paper's own curve, which it gives back:

{table(titles, lines)}

![AP against measurement](ap_curves.png)

Pedestrians and cyclists agree with the paper's slope within the errors. Cars saturate near m = 1, and their
curve is steeper. The detector had seen drives that overlap these, so AP is on the high side.
"""


def priors(facts: Facts) -> str:
    """Return the priors' plot."""
    return """
## The priors

![Density over the ground and over height](priors.png)

Left over the ground, right over height; on scales of their own. [metric.md](../metric.md#the-prior) has
their constants and sources.
"""


def how_made(facts: Facts) -> str:
    """Return commit, machine, seeds and cost."""
    made, effort = facts.made, facts.effort
    searches = facts.search_seconds()
    longest = max(searches)
    total = sum(facts.seconds.values())
    scored = (
        "the whole grid of 64 million voxels"
        if not effort.samples
        else (f"{effort.samples:,} voxels drawn from the prior")
    )
    seeds = ", ".join(str(s) for s in effort.seeds)
    return f"""
## How it was made

| | |
| --- | --- |
| commit | {made["commit"]} |
| machine | {made["machine"]} |
| versions | perception-entropy {made["version"]}, Python {made["python"]}, NumPy {made["numpy"]} |
| scores | on {scored} |
| searches | Algorithm 1: seven rounds of {effort.candidates} candidates, each judged on {effort.search_samples:,} voxels |
| seeds | {seeds} |
| cost | {len(searches)} searches and {len(facts.seconds) - len(searches)} other tasks, {total / 60:.0f} minutes of one processor |
| one search | {min(searches) / 60:.1f} to {longest / 60:.1f} minutes on one processor; the paper's takes "around an hour" ({HOUR_S / longest:.0f} to {HOUR_S / min(searches):.0f} times as long) |

Again: `pe reproduce` (or `pe reproduce --quick`, in a minute, for the orderings alone).
"""

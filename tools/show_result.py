#!/usr/bin/env python3
"""Say in three lines what an optimization moved, gained and cost; then which file has more.

usage: tools/show_result.py FOLDER
"""

import json
import sys
from pathlib import Path

WAYS = (("forward", "back"), ("to the left", "to the right"), ("up", "down"))
"""Directions of x, y and z: of positive and of negative values."""
SMALLEST_M = 0.01
SMALLEST_DEG = 0.1
PAGE = "review.html"
SCENE = "optimized.blend"
RESULT = "result.json"


def moved(placements: dict) -> str:
    """Return which sensor was moved how far, and tilted."""
    sensors = []
    for name, start in placements["before"].items():
        end = placements["after"][name]
        steps = [
            f"{abs(b - a):.2f} m {ways[b < a]}"
            for a, b, ways in zip(start["position"], end["position"], WAYS, strict=True)
            if abs(b - a) >= SMALLEST_M
        ]
        tilt = end["rotation"][1] - start["rotation"][1]
        if abs(tilt) >= SMALLEST_DEG:
            steps.append(f"tilted {abs(tilt):.1f} degrees {'down' if tilt > 0 else 'up'}")
        sensors.append(f"{name} {', '.join(steps) or 'stays'}")
    return "; ".join(sensors)


def better(result: dict) -> str:
    """Return how much better the sensors see."""
    before, after = (result["figures"][which]["values"] for which in ("before", "after"))
    error = result["change_stderr"]["traffic_ap"]
    blind = [values["blind_ground"] for values in (before, after)]
    ap = [values["traffic_ap"] for values in (before, after)]
    return (
        f"blind ground within 10 m of the car was {blind[0]:.0f} m2, now {blind[1]:.0f} m2;"
        f" expected AP of a detector in traffic was {ap[0]:.3f}, now {ap[1]:.3f}"
        f" ({ap[1] - ap[0]:+.3f} +- {error:.3f})"
    )


def main() -> int:
    """Run the command line."""
    folder = Path(sys.argv[1]).resolve()
    result = json.loads((folder / RESULT).read_text("utf-8"))
    files = {PAGE: "in a browser", SCENE: "in Blender", RESULT: "in an editor"}
    made = [f"{folder / name} {where}" for name, where in files.items() if (folder / name).exists()]
    print(f"Moved:   {moved(result['placements'])}")
    print(f"Better:  {better(result)}")
    print(f"Worse:   {result['cost'].removeprefix('Worse: ')}")
    print(f"More:    {'; '.join(made[:2])}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

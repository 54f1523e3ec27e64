"""KITTI's labels: object benchmark (label_2), or tracking, which has frame and id first. A line is
``type truncated occluded alpha left top right bottom height width length x y z rotation_y [score]``
in the left camera's frame (x right, y down, z forward). The location is the middle of the box's
bottom; rotation_y turns about y and is 0 where the object heads along x."""

import math
from collections.abc import Sequence

from pe_core.base.errors import InputError
from pe_core.base.files import NUMBER, parse_number, quoted

from .labels import Labels

CAMERA = (-0.33, 0.0, 1.65)
"""The camera in the ground frame under the middle of the wheelbase [m]. KITTI's set-up: 1.65 m
above the ground, 0.27 m ahead of the LiDAR, which stands 0.76 m ahead of the rear axle; the
Passat's wheelbase is 2.71 m."""

CLASSES = {
    "car": "car",
    "van": "car",
    "truck": "truck",
    "pedestrian": "pedestrian",
    "person_sitting": "pedestrian",
    "person": "pedestrian",
    "cyclist": "cyclist",
}  # KITTI's classes by name; trams and Misc (trailers and similar) are left out
UNLABELLED = "dontcare"

COLUMNS = 15
FIRST_NUMBER = 8
NUMBERS = ("the height", "the width", "the length", "x", "y", "z", "rotation_y")


def looks_like_kitti(line: str) -> bool:
    """Whether a line is a class and numbers, or two numbers, a class and numbers, with blanks."""
    name, number = [*line.split(maxsplit=2), "", ""][:2]
    return _is_number(number) or bool(number and name.lower() in {*CLASSES, UNLABELLED})


def read_kitti(source: str, lines: Sequence[tuple[int, str]]) -> Labels:
    """Read labels from numbered lines."""
    labels = Labels(source)
    tracking = _is_number(lines[0][1].split()[0])
    skipped = 2 if tracking else 0
    expected = "frame, id and 15 columns" if tracking else "15 columns"
    for number, line in lines:
        where = f"line {number}"
        cells = line.split()
        if len(cells) - skipped not in (COLUMNS, COLUMNS + 1):
            kitti = f"KITTI's {expected}, and perhaps a score"
            raise InputError(source, where, kitti, f"{len(cells)} columns")
        name = cells[skipped].lower()
        cells = cells[skipped:]
        if name == UNLABELLED:
            labels.left_out["marked DontCare"] += 1
            continue
        if _is_number(name):
            raise InputError(source, where, "a class before the numbers", quoted(name))
        texts = cells[FIRST_NUMBER : FIRST_NUMBER + len(NUMBERS)]
        height, width, length, right, down, forward, turn = (
            parse_number(source, where, what, text)
            for what, text in zip(NUMBERS, texts, strict=True)
        )
        yaw = -turn - math.pi / 2.0
        # along the axes of the ground frame, relative to the camera
        row = forward, -right, -down + height / 2.0, length, width, height, yaw
        if name in CLASSES:
            labels.add(where, CLASSES[name], row, CAMERA)
        else:
            labels.count_left_out(f"of unknown class {quoted(cells[0])}")
    return labels


def _is_number(text: str) -> bool:
    return NUMBER.fullmatch(text) is not None

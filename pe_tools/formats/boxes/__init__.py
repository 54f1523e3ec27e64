"""Labelled boxes from a file; the content decides the layout."""

import json
from dataclasses import replace
from pathlib import Path

from pe_core.base.errors import InputError, report_memory_errors, size_text
from pe_core.base.files import LABEL_BYTES, decode_text, is_binary, quoted, read_bytes, write_bytes
from pe_core.prior.boxes import Boxes

from ..csv_rows import SEPARATORS
from .kitti import looks_like_kitti, read_kitti
from .labels import Labels, joined
from .nuscenes import read_nuscenes
from .plain import csv_bytes, read_csv

__all__ = ["read_boxes", "write_boxes"]

LAYOUTS = "boxes as KITTI's label_2, as nuScenes' JSON or as CSV with a header"


def read_boxes(path: str | Path, origin: tuple[float, float, float] | None = None) -> Boxes:
    """Read labelled boxes from a file, or from all files of a folder in the order of their names.

    Layouts: KITTI's label_2 and tracking labels (camera frame), nuScenes' annotations or results as
    JSON (in the vehicle's frame, not a map's), and CSV with the columns class, x, y, z (centre),
    length, width, height [m] and yaw [deg].

    Parameters
    ----------
    path : path
    origin : (x, y, z) float, optional
        The origin of the labels in the ground frame [m]. By default KITTI's camera is at
        `kitti.CAMERA`, and other labels are in the ground frame.
    """
    path = Path(path)
    with report_memory_errors(path):
        labels = joined(_read_folder(path) if path.is_dir() else [_read_file(path)], str(path))
    if not labels.names:
        found = ", ".join(f"{n:,} {reason}" for reason, n in labels.left_out.items()) or "none"
        raise InputError(path, "boxes", "at least one box of a known class", found)
    return replace(labels.boxes(origin), file=str(path))


def write_boxes(path: str | Path, boxes: Boxes) -> None:
    """Write boxes as CSV, atomically; `read_boxes` gives them back to the bit."""
    write_bytes(Path(path), csv_bytes(boxes))


def _read_folder(path: Path) -> list[Labels]:
    try:
        files = sorted(p for p in path.iterdir() if p.is_file() and not p.name.startswith("."))
        size = sum(p.stat().st_size for p in files)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(path, "folder", "a folder that can be read", reason) from None
    if not files:
        raise InputError(path, "folder", "files with labels", "none")
    if size > LABEL_BYTES:
        raise InputError(path, "folder", f"at most {LABEL_BYTES:,} bytes", size_text(size))
    return [_read_file(file, may_be_empty=True) for file in files]


def _read_file(path: Path, may_be_empty: bool = False) -> Labels:
    """Read one file. In a folder an empty one is a frame without objects."""
    source = str(path)
    data = read_bytes(path, LABEL_BYTES)
    if is_binary(data):
        raise InputError(source, "file", LAYOUTS, "binary data")
    text = decode_text(data)
    if not text.strip():
        if may_be_empty:
            return Labels(source)
        raise InputError(source, "file", LAYOUTS, "an empty file")
    is_json = text.lstrip()[0] in "[{"
    if is_json:
        try:
            data_of_json = json.loads(text)
        except json.JSONDecodeError as error:
            found = f"{error.msg.lower()} in column {error.colno}"
            raise InputError(source, f"line {error.lineno}", "JSON", found) from None
        except (RecursionError, ValueError) as error:  # ValueError: a number of too many digits
            raise InputError(source, "file", "JSON of boxes", str(error).lower()) from None
        return read_nuscenes(source, data_of_json)
    numbered = enumerate(text.split("\n"), 1)
    lines = [(n, line) for n, line in numbered if line.strip() and line.lstrip()[0] != "#"]
    if not lines:
        raise InputError(source, "file", LAYOUTS, "only comments")
    first = lines[0][1]
    if any(separator in first for separator in SEPARATORS):
        return read_csv(source, lines)
    if looks_like_kitti(first):
        return read_kitti(source, lines)
    raise InputError(source, f"line {lines[0][0]}", LAYOUTS, quoted(first.strip()))

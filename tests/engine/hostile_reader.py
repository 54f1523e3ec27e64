"""Reads files that are out to do harm, each with little memory, and says how that went.

Run as ``python -m tests.engine.hostile_reader LIST``, in a process of its own: LIST is JSON,
[name, reader, path] each. A line of JSON comes back at once for each, so that whoever waits knows
the one that hung. The address space is limited to `ROOM_BYTES` more than is in use at the start.
"""

from __future__ import annotations

import json
import resource
import sys
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import trimesh  # noqa: F401  (before memory is limited)

import pe_core as pe
import pe_tools as pt
from pe_tools.formats import read_ap_table
from pe_tools.formats.angles import read_angles

ROOM_BYTES = 400 << 20
READERS: dict[str, Callable[[Path], Any]] = {
    "mesh": pt.read_mesh,
    "boxes": pt.read_boxes,
    "angles": read_angles,
    "table": read_ap_table,
    "study": pe.load_study,
}


def limit_memory() -> None:
    """No more than `ROOM_BYTES` beyond what this process has now."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + ROOM_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def outcome(reader: str, path: Path) -> dict[str, Any]:
    """How reading went: ``read``, ``refused`` with the line, or ``failed`` with the traceback."""
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        try:
            READERS[reader](path)
            how, line = "read", ""
        except pe.InputError as error:
            how, line = "refused", str(error)
        except BaseException:
            how, line = "failed", traceback.format_exc(limit=-5)[-2000:]
    return {"how": how, "line": line, "warnings": [str(w.message) for w in seen]}


def main() -> None:
    """Read all files of the list."""
    cases = json.loads(Path(sys.argv[1]).read_text())
    for reader in READERS.values():  # what they import on their first call is not the files' fault
        with suppress(pe.InputError):
            reader(Path("/none.obj"))
    limit_memory()
    for name, reader, path in cases:
        print(json.dumps({"name": name, **outcome(reader, Path(path))}), flush=True)


if __name__ == "__main__":
    main()

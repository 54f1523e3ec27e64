"""Which AP curves whole objects have: `[ap] model = "paper"`, or `"scans"`.

The curves from scans are fitted to the detectors of our own study, docs/validity/own; `python -m
studies.detectors --curves` writes them. They are of LiDARs alone: other kinds keep the paper's.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ..base.files import decode_text, read_bytes
from ..base.serialization import load_toml
from ..base.setting import OneOf, Panel, setting
from ..base.table_reader import Table
from ..metric.entropy import ApCurve
from .kind import ClassCurves

PAPER, SCANS = "paper", "scans"
CURVE_MODELS = (PAPER, SCANS)
MODEL: str = setting(
    PAPER,
    OneOf(CURVE_MODELS),
    "AP curves of whole objects: from publications, or of LiDARs fitted to detectors on scans",
    Panel(
        "ap_model",
        "Object AP",
        menu=(
            ("Publications", "Fitted to published detectors, or converted from the paper's curves"),
            ("Scans", "LiDARs: fitted to detectors that this project trained on simulated scans"),
        ),
    ),
    scored=True,
)
"""The field of `PerceptionModel`."""
FILE = Path(__file__).with_name("scans.toml")


@dataclass(frozen=True, slots=True)
class ScanCurves:
    """The curves from scans, by kind and class, and the runs that they are fitted to."""

    curves: ClassCurves
    runs: int
    planned: int

    @property
    def complete(self) -> bool:
        """Whether all planned runs are done; until then the curves are provisional."""
        return self.runs == self.planned


@cache
def scan_curves() -> ScanCurves:
    """Return the curves of the file that is part of the engine."""
    table = Table(load_toml(FILE, "curves", decode_text(read_bytes(FILE))), FILE.name)
    kinds = table.table("curves")
    curves = {kind: _of_kind(kinds.table(kind)) for kind in kinds.names}
    return ScanCurves(curves, table.whole("runs"), table.whole("planned"))


def _of_kind(table: Table) -> dict[str, ApCurve]:
    own = {name: table.table(name) for name in table.names}
    return {name: ApCurve(row.number("a"), row.number("b")) for name, row in own.items()}

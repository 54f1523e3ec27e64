"""Known defects by version: those of a version, and those that a result may have from an older one.

The table is known_defects.toml. A result keeps the version that made it (`run.versions`).
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from pe_core.base.codec import Recorded
from pe_core.version import __version__

TABLE = Path(__file__).with_name("known_defects.toml")
IN_EVERY_RESULT = "entropy"


@dataclass(frozen=True, slots=True)
class Defect(Recorded):
    """A row of the table: `first` and `fixed` are versions, "" where it is not fixed yet;
    `touches` are keys of result.json, `link` is a page below docs/."""

    id: str
    first: str
    touches: Sequence[str]
    what: str
    link: str
    fixed: str = ""

    def is_in(self, version: str) -> bool:
        """Whether a version has the defect."""
        number = _numbers(version)
        begun = _numbers(self.first) <= number
        return begun and not (self.fixed and _numbers(self.fixed) <= number)


@lru_cache(maxsize=1)
def known_defects() -> tuple[Defect, ...]:
    """Return all rows of the table."""
    return read_defects(tomllib.loads(TABLE.read_text("utf-8")))


def read_defects(data: Mapping[str, Any]) -> tuple[Defect, ...]:
    """Return the rows of a table as it is read from its file."""
    return tuple(Defect(**row) for row in data.get("defect", ()))


def defects_of(version: str) -> list[Defect]:
    """Return the defects of a version."""
    return [each for each in known_defects() if each.is_in(version)]


def fixed_since(
    result: Mapping[str, Any], defects: Iterable[Defect] | None = None, version: str = __version__
) -> list[str]:
    """Return a line for each defect that a result may have and a later version, up to this one, has
    fixed; none for data that do not say their version."""
    made = made_by(result)
    rows = known_defects() if defects is None else defects
    if not made:
        return []
    return [
        f"a result of version {made} may have a defect that {each.fixed} fixed: {each.what}"
        for each in rows
        if each.is_in(made) and not each.is_in(version) and _is_touched(each, result)
    ]


def made_by(result: Mapping[str, Any]) -> str:
    """Return the version that made a result, as result.json holds it; "" where it does not say."""
    run = result.get("run")
    versions = run.get("versions") if isinstance(run, dict) else None
    made = versions.get("perception-entropy") if isinstance(versions, dict) else None
    return made if isinstance(made, str) and _numbers(made) else ""


def _is_touched(defect: Defect, result: Mapping[str, Any]) -> bool:
    return any(key == IN_EVERY_RESULT or result.get(key) for key in defect.touches)


def _numbers(version: str) -> tuple[int, ...]:
    """Return the numbers of a version: (0, 1, 0) of "0.1.0.dev3"; empty for another text."""
    leading = []
    for part in version.split("."):
        if not (part.isascii() and part.isdecimal()):
            break
        leading.append(int(part))
    return tuple(leading)

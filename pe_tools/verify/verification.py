"""The engine held to its golden cases: what failed, with versions, machine and digests."""

import hashlib
import os
import platform
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import pe_core
from pe_core.base.values import rounded
from pe_core.version import __version__

from ..known_defects import Defect, defects_of
from .golden import golden_cases
from .golden_case import CaseValues, GoldenCase

SHOWN_VALUES = 12
"""Longest list of values in a report; of a longer one there is the digest and the first that is
wrong."""
DIGITS = 12
SUFFIXES = (".py", ".toml", ".npz")


@dataclass(frozen=True, slots=True)
class CaseResult:
    """What came of a case: `error` is the exception of one that could not be computed."""

    case: GoldenCase
    passed: bool
    found: CaseValues
    right: CaseValues
    seconds: float
    error: str = ""

    @property
    def first_wrong(self) -> str:
        """The first value that is wrong, beside the right one; "" where all are right."""
        if self.passed:
            return ""
        if self.error:
            return self.error
        if isinstance(self.found, str) or isinstance(self.right, str):
            return f"{self.found} in place of {self.right}"
        if len(self.found) != len(self.right):
            return f"{len(self.found)} values in place of {len(self.right)}"
        pairs = enumerate(zip(self.found, self.right, strict=True))
        wrong = ((k, a, b) for k, (a, b) in pairs if not self.case.is_right([a], [b]))
        number, found, right = next(wrong)
        return f"value {number + 1}: {found:.10g} in place of {right:.10g}"

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        return {
            "name": self.case.name,
            "area": self.case.area,
            "basis": self.case.basis,
            "about": self.case.about,
            "passed": self.passed,
            "tolerance": self.case.tolerance,
            "found": _shown(self.found),
            "right": _shown(self.right),
            "digest": digest_of(self.found),
            "wrong": self.first_wrong,
            "seconds": round(self.seconds, 3),
        }


@dataclass(frozen=True, slots=True)
class Verification:
    """All results, and how long they took [s]."""

    results: Sequence[CaseResult]
    seconds: float

    @property
    def failed(self) -> list[CaseResult]:
        """The results that are wrong."""
        return [each for each in self.results if not each.passed]

    @property
    def failures(self) -> list[str]:
        """A line for each case that is wrong."""
        return [
            f"FAILED {each.case.area}, {each.case.name}: {each.first_wrong}" for each in self.failed
        ]

    @property
    def in_short(self) -> str:
        """How many cases are right."""
        count = len(self.results)
        right = count - len(self.failed)
        return f"{right} of {count} golden cases are right, {self.seconds:.1f} s"

    @property
    def defects(self) -> Sequence[Defect]:
        """Defects that are known of this version."""
        return defects_of(__version__)

    @property
    def results_digest(self) -> str:
        """A digest of all values."""
        return digest_of(" ".join(digest_of(each.found) for each in self.results))


def verify_in_short() -> tuple[str, ...]:
    """Hold the engine to all golden cases; return a line that says how many are right, and one for
    each that is wrong."""
    found = verify()
    return found.in_short, *found.failures


def verifying() -> Iterator[CaseResult]:
    """Hold the engine to all golden cases, one after the other."""
    for case in golden_cases():
        yield _result_of(case)


def verify() -> Verification:
    """Hold the engine to all golden cases."""
    begun = time.monotonic()
    return Verification(tuple(verifying()), time.monotonic() - begun)


def _result_of(case: GoldenCase) -> CaseResult:
    begun = time.monotonic()
    right: CaseValues = ()
    try:
        right = case.right_values
        found = case.found()
    except Exception as error:  # a case that cannot be computed has failed, whatever the reason
        text = f"{type(error).__name__}: {error}"
        return CaseResult(case, False, (), right, seconds=time.monotonic() - begun, error=text)
    passed = case.is_right(found, right)
    return CaseResult(case, passed, found, right, seconds=time.monotonic() - begun)


def digest_of(values: CaseValues) -> str:
    """Return a digest of values, numbers rounded as scores are: NumPy's logarithms and sines differ
    in the last bit between processors."""
    text = values if isinstance(values, str) else repr([rounded(value) for value in values])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@lru_cache(maxsize=1)
def code_digest() -> str:
    """Return a digest of all files of pe_core and pe_tools as they are installed."""
    found = hashlib.sha256()
    for package in (Path(pe_core.__file__).parent, Path(__file__).parent.parent):
        for path in sorted(package.rglob("*")):
            if path.suffix in SUFFIXES and path.is_file():
                name = path.relative_to(package).as_posix()
                found.update(f"{package.name}/{name}\n".encode() + path.read_bytes())
    return found.hexdigest()[:16]


def machine() -> dict[str, Any]:
    """Return what is known of the machine."""
    return {
        "system": platform.platform(),
        "architecture": platform.machine(),
        "processors": os.cpu_count() or 0,
    }


def _shown(values: CaseValues) -> Any:
    if isinstance(values, str):
        return values
    rounded = [float(f"{value:.{DIGITS}g}") for value in values[:SHOWN_VALUES]]
    return rounded if len(values) <= SHOWN_VALUES else [*rounded, f"{len(values)} values"]

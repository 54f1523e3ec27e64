"""The page of `pe verify`: all golden cases, with versions, machine and digests."""

from collections.abc import Mapping
from typing import Any

from .document import html_file
from .markup import render

HEADS = ("case", "right values", "result", "time [s]")


def verification_page(data: Mapping[str, Any]) -> bytes:
    """Return the page of what verify.json holds."""
    areas: dict[str, list[Mapping[str, Any]]] = {}
    for case in data["cases"]:
        areas.setdefault(case["area"], []).append(case)
    facts = {
        **data["versions"],
        **{name: str(text) for name, text in data["machine"].items()},
        **{f"digest of {name}": text for name, text in data["digests"].items()},
    }
    count = len(data["cases"])
    body = render(
        "verification.html",
        title=f"{data['passed']} of {count} golden cases are right",
        failed=[case for case in data["cases"] if not case["passed"]],
        areas=areas,
        bases=data["bases"],
        defects=data["known_defects"],
        facts=facts,
        heads=list(HEADS),
        seconds=data["seconds"],
    )
    return html_file("Verification of perception-entropy", body)

"""The verb ``pe verify``: the engine as it is installed, held to its golden cases."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

from pe_core.base import dump_json
from pe_core.base.plugins import shipped
from pe_core.base.table_reader import finite

from .. import cli as app
from .. import jobs
from ..wording import aligned
from .verification import Verification, verify

JSON_FILE = "verify.json"
PAGE_FILE = "verify.html"
FILES = (JSON_FILE, PAGE_FILE)


def verify_engine(args: argparse.Namespace, versions: Mapping[str, str] | None) -> app.Answer:
    """Hold the engine to all golden cases and return what is printed; exit status 3 where one
    fails. `versions` are those of programs around the engine, by name."""
    folder = None if args.output is None else jobs.prepare_folder(args.output, FILES)
    found = verify()
    data = report(found, versions)
    if folder is not None:
        with jobs.FileSet(folder) as files:
            files.add(PAGE_FILE, shipped("page.verification")(data))
            files.add(JSON_FILE, dump_json(data).encode(errors="backslashreplace"))
        app.tell(f"wrote {folder / PAGE_FILE}")
    status = app.NOT_MET if found.failed else app.DONE
    return dump_json(data) if args.json else "\n".join(lines(found, data)), status


def report(found: Verification, versions: Mapping[str, str] | None) -> dict[str, Any]:
    """Return what verify.json holds, with further versions."""
    data = found.to_dict()
    data["versions"] |= versions or {}
    whole: dict[str, Any] = finite(data)
    return whole


def lines(found: Verification, data: Mapping[str, Any]) -> Sequence[str]:
    """Return the lines for readers: counts by area, what failed, versions, machine, digests."""
    areas = dict.fromkeys(each.case.area for each in found.results)
    rows = [["area", "right", "of"]]
    for area in areas:
        own = [each.passed for each in found.results if each.case.area == area]
        rows.append([area, str(sum(own)), str(len(own))])
    versions = ", ".join(f"{name} {text}" for name, text in data["versions"].items())
    digests = ", ".join(f"{name} {text}" for name, text in data["digests"].items())
    machine = data["machine"]
    return [
        *aligned(rows),
        *found.failures,
        found.in_short,
        f"versions  {versions}",
        f"machine   {machine['system']}, {machine['processors']} processors",
        f"digests   {digests}",
        f"known defects of this version: {len(found.defects)} (docs/credibility.md)",
    ]

"""The verb ``pe verify``: the engine as it is installed, held to its golden cases."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence

from pe_core.base import dump_json, record
from pe_core.base.plugins import shipped
from pe_core.base.table_reader import finite

from .. import cli as app
from .. import jobs
from ..wording import aligned
from .golden_case import BASES
from .verification import Verification, code_digest, machine, verify

JSON_FILE = "verify.json"
PAGE_FILE = "verify.html"
FILES = (JSON_FILE, PAGE_FILE)


def verify_engine(args: argparse.Namespace, versions: Mapping[str, str] | None) -> app.Answer:
    """Hold the engine to all golden cases and return what is printed; exit status 3 where one
    fails. `versions` are those of programs around the engine, by name."""
    folder = None if args.output is None else jobs.prepare_folder(args.output, FILES)
    found = verify()
    told = report(found, versions or {})
    if folder is not None:
        data = finite(record(told))
        with jobs.FileSet(folder) as files:
            files.add(PAGE_FILE, shipped("page.verification")(data))
            files.add(JSON_FILE, dump_json(data).encode(errors="backslashreplace"))
        app.tell(f"wrote {folder / PAGE_FILE}")
    status = app.NOT_MET if found.failed else app.DONE
    return app.answered(args, told, lines(found, told)), status


def report(found: Verification, versions: Mapping[str, str]) -> app.VerifyAnswer:
    """Return what verify.json holds; `versions` are further ones."""
    return app.VerifyAnswer(
        passed=len(found.results) - len(found.failed),
        failed=len(found.failed),
        versions=jobs.run_record(found.seconds, versions).versions,
        machine=machine(),
        digests={"code": code_digest(), "results": found.results_digest},
        bases=BASES,
        cases=tuple(each.to_dict() for each in found.results),
        known_defects=tuple(each.to_dict() for each in found.defects),
        seconds=round(found.seconds, 2),
    )


def lines(found: Verification, told: app.VerifyAnswer) -> Sequence[str]:
    """Return the lines for readers: counts by area, what failed, versions, machine, digests."""
    areas = dict.fromkeys(each.case.area for each in found.results)
    rows = [["area", "right", "of"]]
    for area in areas:
        own = [each.passed for each in found.results if each.case.area == area]
        rows.append([area, str(sum(own)), str(len(own))])
    versions = ", ".join(f"{name} {text}" for name, text in told.versions.items())
    digests = ", ".join(f"{name} {text}" for name, text in told.digests.items())
    return [
        *aligned(rows),
        *found.failures,
        found.in_short,
        f"versions  {versions}",
        f"machine   {told.machine['system']}, {told.machine['processors']} processors",
        f"digests   {digests}",
        f"known defects of this version: {len(found.defects)} (docs/credibility.md)",
    ]

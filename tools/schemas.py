#!/usr/bin/env python3
"""Write docs/schemas: JSON Schemas of study.toml, result.json and what verbs print.

All are of the declarations that the data are read and written by. A test holds them to real
files.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from pe_core.base import schema_of_record, schemas_of_records  # noqa: E402
from pe_core.study import SCHEMA  # noqa: E402
from pe_core.study import study_schema as schema_of_study  # noqa: E402
from pe_tools.cli import VERBS  # noqa: E402
from pe_tools.jobs import ResultRecord  # noqa: E402

FOLDER = ROOT / "docs" / "schemas"
STUDY_SCHEMA = 1
ANSWERS_SCHEMA = 1
"""Versions of the schemas of a study and of what verbs print: own numbers, as that of a result."""
DRAFT = "https://json-schema.org/draft/2020-12/schema"


def study_schema() -> dict[str, Any]:
    """Return the schema of study.toml."""
    head = {"$schema": DRAFT, "$id": f"urn:perception-entropy:study:{STUDY_SCHEMA}"}
    title = "A study of perception entropy: study.toml as plain data; lengths in m, angles in deg"
    return {**head, "title": title, **schema_of_study()}


def result_schema() -> dict[str, Any]:
    """Return the schema of result.json."""
    head = {"$schema": DRAFT, "$id": f"urn:perception-entropy:result:{SCHEMA}"}
    title = "A result of perception entropy: result.json"
    return {**head, "title": title, **schema_of_record(ResultRecord)}


def answers_schema() -> dict[str, Any]:
    """Return the schema of what verbs print with ``--json``, by verb."""
    head = {"$schema": DRAFT, "$id": f"urn:perception-entropy:answers:{ANSWERS_SCHEMA}"}
    title = "What the verbs of pe print with --json, by verb"
    return {**head, "title": title, **schemas_of_records({v.name: v.answer for v in VERBS})}


def pages() -> dict[str, str]:
    """Return the text of each schema, by the name of its file."""
    made = {
        f"study-{STUDY_SCHEMA}.schema.json": study_schema(),
        f"result-{SCHEMA}.schema.json": result_schema(),
        f"answers-{ANSWERS_SCHEMA}.schema.json": answers_schema(),
    }
    return {
        name: json.dumps(data, indent=1, ensure_ascii=False) + "\n" for name, data in made.items()
    }


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, text in pages().items():
        (FOLDER / name).write_text(text, "utf-8")

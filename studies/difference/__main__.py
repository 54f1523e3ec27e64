"""``python -m studies.difference [--cameras FILE]``: what a difference in score is worth."""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path

from pe_core import InputError
from pe_core.base import decode_text, dump_json, dumps, read_bytes, write_bytes
from pe_core.search import FIGURES
from pe_tools import prepare_folder
from pe_tools.cli import DONE, Answer

from ..command import main, page_parser
from ..pages import check_page, joined, render, write_study
from ..results_file import RESULTS, Json, made_by, plain, print_progress, read_json
from .kinds import SCORES, camera_kind_of, own_kinds, published_kind
from .worth import DifferenceEffort, Kind, worth_of

FOLDER = "docs/validity/difference"
QUICK_FOLDER = "validity-difference-quick"
TITLE = "# What a difference in score is worth"
PLAN = Path(__file__).parents[2] / FOLDER / "plan.md"
QUICK = DifferenceEffort(resamples=50)
COLUMNS = ("k", "k_low", "k_high", "largest", "rigs", "pairs", "source")
SCOPE = ("of_class", "within", "sensors")
"""What the scores of a kind are of, where it is less than all classes in the default space."""
HEAD = """\
# How often the rig with the better score had the higher AP: P = 1 / (1 + exp(-k d)), d a difference
# in units of the score (nats, AP, share). A row is here by the rule of docs/validity/difference.
# Written by `python -m studies.difference --table FILE`; do not edit it.

"""


def worth_of_differences(args: argparse.Namespace, folder: Path) -> Answer:
    """Write the page and results.json, and the table of the product where it is asked for."""
    check_page(folder, TITLE, "difference")
    folder = prepare_folder(folder)
    if args.page_only:
        found = read_json(folder / RESULTS)
    else:
        kinds = [*own_kinds(), published_kind()]
        kinds += [camera_kind_of(Path(args.cameras))] if args.cameras else []
        found = measured(kinds, QUICK if args.quick else DifferenceEffort())
    write_study(folder, found, page_of(found))
    if args.table:
        write_table(Path(args.table), found)
    return dump_json(found) if args.json else _summary(found), DONE


def measured(kinds: Sequence[Kind], effort: DifferenceEffort) -> Json:
    """Return all figures by kind and score as JSON data."""
    found: Json = {"made": made_by(effort), "kinds": {}}
    found["plan"] = hashlib.sha256(read_bytes(PLAN)).hexdigest()
    for kind in kinds:
        rows = {}
        for score in SCORES:
            print_progress(f"{kind.label}: {score}")
            rows[score] = worth_of(kind, score, effort)
        row = {"label": kind.label, "source": kind.source, "smallest": kind.smallest}
        scope = {key: value for key in SCOPE if (value := getattr(kind, key))}
        found["kinds"][kind.name] = {**row, **scope, "scores": rows}
    return plain(found)


def table_text(found: Json) -> str:
    """Return the table of the product, TOML: a row a kind and score that enters it."""
    rows = []
    for name, kind in found["kinds"].items():
        for score, row in kind["scores"].items():
            if row["in_table"]:
                low, high = row["interval"]
                values = {**row, "k_low": low, "k_high": high, "source": kind["source"]}
                own = {key: values[key] for key in COLUMNS}
                own |= {key: kind[key] for key in SCOPE if key in kind}
                rows.append({"kind": name, "score": score, **own})
    return HEAD + dumps({"difference": rows})


def write_table(path: Path, found: Json) -> None:
    """Write the table; another file at the path is an `InputError`."""
    if path.exists() and not decode_text(read_bytes(path)).startswith(HEAD):
        raise InputError(path, "table", "a table of python -m studies.difference", "another file")
    write_bytes(path, table_text(found).encode())


def page_of(found: Json) -> str:
    """Return the page as Markdown."""
    values: Json = {"found": found, "names": score_names()}
    values |= {"entered": listed(found, True), "left_out": listed(found, False)}
    return render(Path(__file__).with_name("page.md.j2"), values, number=number_text)


def listed(found: Json, in_table: bool) -> list[str]:
    """Return the kinds with those of their scores that are in the table, or are not."""
    names = score_names()
    by_kind = {
        kind["label"]: [
            names[s] for s, row in kind["scores"].items() if row["in_table"] == in_table
        ]
        for kind in found["kinds"].values()
    }
    return [f"{label} ({joined(scores)})" for label, scores in by_kind.items() if scores]


def score_names() -> Mapping[str, str]:
    """Return what the scores are called on the page."""
    return {key: FIGURES[key].name for key in SCORES}


def number_text(value: float | None) -> str:
    """Return a number with three digits; a dash where there is none."""
    return "-" if value is None else f"{value:.3g}"


def _summary(found: Json) -> str:
    """Return the verdicts by kind and score, for people."""
    return "\n".join(
        f"{kind['label']}, {score}: {row['share']:.2f} of {row['pairs']} pairs right; "
        + "; ".join(f"{k} {verdict}" for k, verdict in row["verdicts"].items())
        + f"; {'in the table' if row['in_table'] else 'not in the table'}"
        for kind in found["kinds"].values()
        for score, row in kind["scores"].items()
    )


if __name__ == "__main__":
    parser, _ = page_parser(
        "difference", str(__doc__), (FOLDER, QUICK_FOLDER), "few bootstraps, in seconds"
    )
    about = "the file of published camera rigs, whose study has its results"
    parser.add_argument("--cameras", metavar="FILE", help=about)
    about = "write the rows that enter the table of the product to this file"
    parser.add_argument("--table", metavar="FILE", help=about)
    main(parser, worth_of_differences)

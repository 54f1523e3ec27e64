"""Reading results.json: a file may be damaged, so all of it is checked before anything is drawn."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.text import dump_json, read_bytes

from .claims import claims
from .effort import FULL, QUICK, Effort, to_dict
from .form import Amount, Each, Form, Keyed, ListOf, Maybe, Text, check_keys
from .paper import CORNERS, PRIORS, ROW
from .plan import names

SCHEMA = 1

ENTROPY, SHARE = Amount(-1e3, 1e3), Amount(0.0, 1.0)
SEEN = Amount(1e-9, 1.0)
"""A share that something is divided by."""
METRES, DEGREES = Amount(-100.0, 100.0), Amount(-360.0, 360.0)
PLACE = Keyed({"position": ListOf(METRES, 3), "rotation": ListOf(DEGREES, 3)})
SCORE = Keyed(
    {"entropy": ENTROPY, "coverage": SEEN, "stderr": Amount(), "per_class": Each(ENTROPY)}
)
SHAPES: Mapping[str, Form] = {
    "printed": SCORE,
    "swapped": SCORE,
    "lidars": SCORE,
    "pitch": Keyed({"entropy": ENTROPY, "alone": Keyed(dict.fromkeys(CORNERS["front"], ENTROPY))}),
    "bound": Keyed(
        {
            "in_view": SEEN,
            "least": ENTROPY,
            "least_all_round": ENTROPY,
            "farthest_m": Amount(0.0),
            "nearer_than_that": SHARE,
            "most_unseen": Amount(),
        }
    ),
    "bound_curve": Keyed({"distance_m": ListOf(Amount(0.0)), "entropy": ListOf(ENTROPY)}),
    "prior": Keyed(
        {
            "classes": ListOf(Text()),
            "ground": ListOf(ListOf(Amount(0.0))),
            "height_m": ListOf(Amount()),
            "height": ListOf(Amount(0.0)),
        }
    ),
    "fit": Keyed(
        {
            **{key: Amount() for key in ("a", "b", "a_error", "b_error", "rms")},
            "m": ListOf(Amount(0.0)),
            "ap": ListOf(SHARE),
            "n": ListOf(Amount(0.0)),
            "left_out": ListOf(Text()),
        }
    ),
}
"""What a result looks like, by the first part of its name."""
VARIED = (Keyed({"entropy": ENTROPY, "coverage": Maybe(SEEN)}), SCORE)
EVEN = (("fit", ("m", "ap", "n", "left_out")), ("prior", ("height_m", "height")))
EVEN_CURVE = ("bound_curve", ("distance_m", "entropy"))
"""Lists of a result that are as long as each other."""
MADE = ("commit", "version", "numpy", "python", "machine")


def read_results(path: Path) -> dict[str, Any]:
    """Read a complete results.json.

    Raises
    ------
    InputError
        When it is not one, of another version, damaged, or its verdicts are not what its figures
        say.
    """
    data = read_json(path)
    if data.get("schema") != SCHEMA or "claims" not in data:
        raise InputError(path, "schema", f"complete results of schema {SCHEMA}", "others")
    check_keys(data, ("schema", "made", "claims", "results"), path, "file")
    effort = _checked_made(path, data["made"])
    results = checked_results(path, data["results"])
    _check_complete(path, effort, results)
    values = {name: entry["value"] for name, entry in results.items()}
    judged = [claim.to_dict() for claim in claims(values, effort)]
    if data["claims"] != json.loads(dump_json(judged)):
        raise InputError(path, "claims", "the verdicts that the results give", "others")
    return data


def read_json(path: Path) -> dict[str, Any]:
    """Read a file of JSON.

    Raises
    ------
    InputError
        When it cannot be read, or holds something else than an object.
    """
    text = read_bytes(path)
    try:
        data = json.loads(text, parse_constant=_refuse)
    except RecursionError:
        raise InputError(path, "file", "valid JSON", "brackets in brackets, too deep") from None
    except ValueError as error:
        raise InputError(path, "file", "valid JSON", error) from None
    if not isinstance(data, dict):
        raise InputError(path, "file", "a JSON object", type(data).__name__)
    return data


CheckValue = Callable[[Path, str, Any, str], None]
"""Takes file, task name, value and field; raises `InputError` unless it is such a task's value."""


def checked_results(path: Path, results: Any) -> dict[str, dict[str, Any]]:
    """Return results by task name, each with its value and seconds, or raise `InputError`."""
    return checked_entries(path, results, _check_value)


def checked_entries(path: Path, results: Any, check_value: CheckValue) -> dict[str, dict[str, Any]]:
    """As `checked_results`, of any verb's tasks."""
    if not isinstance(results, dict):
        raise InputError(path, "results", "an object", type(results).__name__)
    for name, entry in results.items():
        Text().check(name, path, "results")
        field = f"results.{name}"
        check_keys(entry, ("value", "seconds"), path, field)
        Amount(0.0).check(entry["seconds"], path, f"{field}.seconds")
        check_value(path, name, entry["value"], f"{field}.value")
    return results


def _refuse(constant: str) -> float:
    raise ValueError(f"{constant}, which JSON has no word for")


def _checked_made(path: Path, made: Any) -> Effort:
    """Return the effort, which is one of the two there are."""
    check_keys(made, (*MADE, "effort"), path, "made")
    for key in MADE:
        Text().check(made[key], path, f"made.{key}")
    for effort in (FULL, QUICK):
        if made["effort"] == to_dict(effort):
            return effort
    raise InputError(path, "made.effort", "that of pe reproduce, or with --quick", "another")


def _check_value(path: Path, name: str, value: Any, field: str) -> None:
    kind, _, rest = name.partition("/")
    if kind in ("search", "pilot"):
        _search_shape(path, rest).check(value, path, field)
    elif kind == "vary":
        full = isinstance(value, dict) and "stderr" in value
        VARIED[full].check(value, path, field)
    elif kind in SHAPES:
        SHAPES[kind].check(value, path, field)
        _check_lists(path, kind, value, field)
    else:
        raise InputError(path, "results", "what pe reproduce computes", ascii(name[:60]))


def _search_shape(path: Path, rest: str) -> Form:
    """A search's result has a place for every sensor of its row."""
    row, _, start = rest.partition("/")
    if row not in ROW or start.split("/")[0] not in PRIORS:
        raise InputError(path, "results", "searches of the paper's rows", ascii(rest[:60]))
    sensors = next(iter(ROW[row].starts.values()))
    return Keyed(
        {
            "entropy": ENTROPY,
            "coverage": SEEN,
            "start_entropy": ENTROPY,
            "evaluations": Amount(0.0),
            "placements": Keyed(dict.fromkeys(sensors, PLACE)),
        }
    )


def _check_lists(path: Path, kind: str, value: Mapping[str, Any], field: str) -> None:
    """Lists that belong together are equally long, and a curve has a point to draw."""
    for about, keys in (*EVEN, EVEN_CURVE):
        if about == kind and len({len(value[key]) for key in keys}) > 1:
            raise InputError(path, field, f"{', '.join(keys)} of one length", "different lengths")
    if kind == "prior" and len({len(line) for line in value["ground"]}) > 1:
        raise InputError(path, f"{field}.ground", "lines of one length", "different lengths")
    if kind == "fit" and not max(value["m"]) > 0.0:
        raise InputError(path, f"{field}.m", "a measurement above 0", "none")


def _check_complete(path: Path, effort: Effort, results: Mapping[str, Any]) -> None:
    values = {name: entry["value"] for name, entry in results.items()}
    expected = set(names(effort, values))
    for name in sorted(expected - set(results))[:1]:
        raise InputError(path, "results", f"a complete run, with {name}", "none")
    for name in sorted(set(results) - expected)[:1]:
        raise InputError(path, "results", "only what this effort computes", name)

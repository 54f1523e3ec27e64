"""The verbs ``explain`` and ``compare``: a study in words, and several side by side."""

from __future__ import annotations

import argparse
import signal
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .. import advice
from ..errors import InputError
from ..study import Outcome, ScoreJob, Study, vehicle_digest
from ..text import dump_json
from ..text.json_text import finite
from .command import add_score_options
from .interrupts import Interrupted, stop_at_first
from .side_by_side import comparison
from .status import DONE, Answer
from .summary import warned, with_error
from .work import drive, tell_vehicle


def add_explain_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``explain`` to a parser."""
    about = "ask one place instead: x, y and perhaps z (else 0) in metres"
    parser.add_argument("--at", type=float, nargs="+", metavar=("X Y", "Z"), help=about)
    about = "class whose reach is told (pedestrian)"
    parser.add_argument("--class", dest="class_name", metavar="NAME", help=about)
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_score_options(parser)


def add_compare_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``compare`` to a parser."""
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_score_options(parser)


def explain(study: Study, args: argparse.Namespace) -> Answer:
    """Tell a study's score in words, with warnings; or one place of it."""
    if args.at is not None:
        parts = (study.rig, study.space, study.prior, study.vehicle, args.at, study.model)
        place = advice.ask_place(*parts)
        tell_vehicle(study)
        return _answer({"place": place.to_dict()}, place.text, args.json)
    name = advice.class_of(study.prior, args.class_name)
    outcome = scored(study, args.workers)
    seen = advice.outlook(study.sight(), study.rig, name)
    scored_rig = outcome.after, study.rig, study.vehicle, seen
    rows = advice.sensor_rows(*scored_rig)
    data = {
        "score": outcome.after.to_dict(),
        **seen.to_dict(),
        "sensors": [row.to_dict() for row in rows],
        "words": list(advice.words(*scored_rig, outcome.warnings)),
        "warnings": [each.to_dict() for each in outcome.warnings],
    }
    of_rig = advice.rig_words(outcome.after, seen, study.rig, outcome.warnings)
    said = *of_rig, *advice.sensor_table(rows)
    return _answer(data, [_entropy(outcome), *said, *warned(outcome)], args.json)


def compare(studies: Mapping[str, Study], args: argparse.Namespace) -> Answer:
    """Score studies by name, and put them side by side."""
    refuse_different(studies)
    scores = {name: scored(study, args.workers).after for name, study in studies.items()}
    rows = advice.compare(scores)
    alike = len({vehicle_digest(study.vehicle) for study in studies.values()}) == 1
    data = {
        "scores": {name: score.to_dict() for name, score in scores.items()},
        "rows": [row.to_dict() for row in rows],
        "same_vehicle": alike,
    }
    notes = [] if alike else ["their vehicles differ"]
    if error := max(score.stderr for score in scores.values()):
        notes.append(
            f"on samples: entropies have a standard error of up to {error:.4f} nats; +- is that of "
            "a difference, smaller on a shared sample"
        )
    names = list(scores)
    said = [*advice.ranking(names, rows), *advice.win_words(names, rows)]
    data["words"] = said
    return _answer(data, [*comparison(names, rows), *said, *notes], args.json)


def named_by_file(paths: list[str]) -> dict[str, str]:
    """Return study files by short names that tell them apart: of the file, or its folder too."""
    for depth in (1, 2):
        names = ["/".join(Path(path).with_suffix("").parts[-depth:]) for path in paths]
        if len(set(names)) == len(names):
            return dict(zip(names, paths, strict=True))
    return dict(zip(paths, paths, strict=False))


def scored(study: Study, workers: int | None) -> Outcome:
    """Score a study, with progress; Ctrl-C ends it."""
    tell_vehicle(study)
    job = ScoreJob(study, workers)
    with stop_at_first(job.stop) as received:
        outcome = drive(job)
    if outcome is None:
        raise Interrupted(received.signum or signal.SIGINT, "no score was complete")
    return outcome


def refuse_different(studies: Mapping[str, Study]) -> None:
    """Raise `InputError` for studies whose scores do not measure the same."""
    first, *others = studies.items()
    for name, study in others:
        for field in ("space", "prior", "model", "targets"):
            if getattr(study, field) != getattr(first[1], field):
                field = "AP curves and fusion" if field == "model" else field
                expected = f"the same as in {first[0]}, to be compared with it"
                raise InputError(name, field, expected, "another")


def _entropy(outcome: Outcome) -> str:
    score = outcome.after
    if score.objects is not None:
        return f"object entropy {with_error(score.entropy, score.stderr)}; lower is better"
    return f"perception entropy {with_error(score.entropy, score.stderr)}; lower is better"


def _answer(data: dict[str, Any], lines: list[str] | tuple[str, ...], as_json: bool) -> Answer:
    return (dump_json(finite(data)) if as_json else "\n".join(lines)), DONE

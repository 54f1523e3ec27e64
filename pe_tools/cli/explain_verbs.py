"""`pe explain` and `pe compare`: a score described in text, and several studies compared."""

import argparse
import math
import signal
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pe_core import catalog
from pe_core.base.errors import InputError, one_of, require_name, shown
from pe_core.base.values import error_text
from pe_core.scene import Vehicle
from pe_core.search import FIGURES, POSITION_AXES, SHOWN
from pe_core.study import Study

from .. import advice
from ..advice import ComparedRow
from ..jobs import Outcome, ScoreJob, SuggestJob
from ..sweep import read_changes
from ..wording import aligned
from .answers import CompareAnswer, ExplainAnswer
from .check_verb import suggested_for, suggestion_lines
from .interrupts import Interrupted, stop_at_first
from .run_job import drive, print_vehicle
from .study_source import StudyFiles
from .terminal import DONE, Answer, answered, warned, with_error

BEST = "*"
NOT_BLIND = "not blind: what is 0.5 m tall is visible there"
WIDEST = 24  # Longer names of studies are cut at the front: their ends tell them apart
COMPARED = ("space", "prior", "model", "targets")
"""Fields that studies must have in common for their scores to be comparable."""


def comparison(names: Sequence[str], rows: Sequence[ComparedRow]) -> list[str]:
    """Return rows as lines with a column for each study. The best value is marked; differences
    refer to the first study."""
    heads = [name if len(name) <= WIDEST else f"...{name[3 - WIDEST :]}" for name in names]
    table = [["", *heads]]
    columns = range(len(heads))
    for name, figure in FIGURES.items():
        own = [row for row in rows if row.measure == name]
        if own:
            table.append([figure.heading, *[""] * len(heads)])
        for row in own:
            traffic = ", in traffic" * (row.group == advice.TRAFFIC)
            table.append([f"  {row.name or 'all'}{traffic}", *(_cell(row, k) for k in columns)])
    lines = aligned(table, range(1, len(table[0])))
    note = f"{BEST} best; in brackets the difference to {heads[0]}"
    return [*lines, *[note] * (len(heads) > 1)]


def _cell(row: ComparedRow, k: int) -> str:
    change = row.change_text(k)
    return f"{row.text(k)}{f' ({change})' * bool(change)}{BEST if row.best[k] else ' '}"


def explain(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Describe a study's score and warnings; with ``--at``, query one location instead; with
    ``--sensor``, tell where a sensor gains most."""
    study = source.study(args)
    at = args.at
    with_body = args.body is not None
    if at is not None and not (len(at) in (2, 3 - with_body) and all(map(math.isfinite, at))):
        expected = f"X Y{'' if with_body else ', perhaps Z'}: numbers of metres"
        raise InputError("command line", "--at", expected, " ".join(f"{v:g}" for v in at))
    nowhere = at is None
    turned = args.heading is not None
    of_class = args.class_name is not None
    with_sensor = args.of_sensor is not None
    with_edges = args.measured_from is not None
    sampled = any(change.path == ("samples",) for change in read_changes(args.set))
    for option, is_idle, expected, found in (
        ("--suggest", args.suggest and with_body, "--at X Y, a place to fix", "--body"),
        ("--suggest", args.suggest and nowhere, "--at X Y, a place to fix", "none"),
        ("--body", with_body and nowhere, "--at X Y, where it stands", "none"),
        ("--heading", turned and not with_body, "--body NAME, which it turns", "none"),
        ("--samples", sampled and not nowhere, "no --at: a place has no sample", "--at"),
        ("--class", of_class and not nowhere, "no --at: it says whose reach is told", "--at"),
        ("--sensor", with_sensor and not nowhere, "no --at: it tells a sensor's way", "--at"),
        ("--from", with_edges and not with_sensor, "--sensor NAME, whose position is told", "none"),
        ("--sensor", with_sensor and of_class, "no --class: it tells a sensor's way", "--class"),
    ):
        if is_idle:
            raise InputError("command line", option, expected, found)
    if with_body:
        standing = advice.StandingBody(args.body, at, args.heading or 0.0)
        (body,) = advice.see_bodies(study.rig, study.vehicle, (standing,), study.model)
        print_vehicle(study)
        return answered(args, ExplainAnswer(outlook={}, body=body.to_dict()), body.text), DONE
    if at is not None:
        place = advice.ask_place(
            study.rig, study.space, study.prior, study.vehicle, point=at, model=study.model
        )
        print_vehicle(study)
        told = list(place.text)
        answer = ExplainAnswer(outlook={}, place=place.to_dict())
        if args.suggest:
            suggested = suggested_for(SuggestJob(study, spot=(at[0], at[1])))
            repairs = tuple(each.to_dict() for own in suggested.values() for each in own)
            answer = replace(answer, suggestions=repairs)
            fixes = [
                line for name, found in suggested.items() for line in suggestion_lines(name, found)
            ]
            told += fixes or [NOT_BLIND] * (not place.in_vehicle)
        return answered(args, answer, told), DONE
    if with_edges:
        return _from_edges(study, args)
    if with_sensor:
        return _steepest_way(study, args)
    name = advice.class_of(study.prior, args.class_name)
    outcome = scored(study, args.workers, source)
    seen = advice.outlook(study.sight(), study.rig, name)
    rows = advice.sensor_rows(outcome.after, study.rig, study.vehicle, seen)
    of_rig = advice.rig_words(outcome.after, seen, study.rig, outcome.warnings)
    data = ExplainAnswer(
        score=outcome.after,
        outlook=seen.to_dict(),
        sensors=tuple(row.to_dict() for row in rows),
        words=tuple(of_rig),
        warnings=outcome.warnings,
    )
    score = outcome.after
    what = "perception" if score.objects is None else "object"
    first = f"{what} entropy {with_error(score.entropy, score.stderr)}; lower is better"
    lines = [first, *of_rig, *advice.sensor_table(rows), *warned(outcome)]
    return answered(args, data, lines), DONE


def _steepest_way(study: Study, args: argparse.Namespace) -> Answer:
    """Tell where a sensor gains most."""
    places = advice.places_of(study, args.of_sensor)
    print_vehicle(study)
    found = advice.steepest_way(
        places, study.evaluator(workers=args.workers), screen=advice.screen_of(study, args.workers)
    )
    told = study.distances(study.rig[args.of_sensor])
    answer = ExplainAnswer(outlook={}, steepest=found.to_dict(), distances=told or None)
    at = [f"{args.of_sensor}: {', '.join(told)}"] if told else []
    return answered(args, answer, [*at, *advice.steepest_lines(found)]), DONE


def _from_edges(study: Study, args: argparse.Namespace) -> Answer:
    """Tell how far a sensor is from edges of the vehicle along each axis that is measured from
    them; without edges list their names."""
    require_name("command line", "--sensor", args.of_sensor, [each.name for each in study.rig])
    edges = study.vehicle_edges
    by_axis = {axis: edges.names(axis) for axis in POSITION_AXES}
    print_vehicle(study)
    if not args.measured_from:
        lines = [f"{axis}: {', '.join(names)}" for axis, names in by_axis.items()]
        return answered(args, ExplainAnswer(outlook={}, edges=by_axis), lines), DONE
    position = study.rig[args.of_sensor].pose.position
    told = []
    for name in args.measured_from:
        axes = [axis for axis, names in by_axis.items() if name in names]
        if not axes:
            known = dict.fromkeys(each for names in by_axis.values() for each in names)
            raise InputError("command line", "--from", one_of(known, name), shown(name))
        told += [edges.distance(name, axis, position).text for axis in axes]
    answer = ExplainAnswer(outlook={}, distances=tuple(told))
    return answered(args, answer, [f"{args.of_sensor}: {', '.join(told)}"]), DONE


def _same_body(one: Vehicle | None, other: Vehicle | None) -> bool:
    if one is None or other is None:
        return one is other
    return bool(np.array_equal(one.triangles, other.triangles))


def compare(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Score studies by name, and print a table that compares them."""
    studies: Mapping[str, Study] = source.studies(args)
    refuse_different(studies)
    studies = _showing_alike({**studies, **_beside(studies, args.beside)})
    outcomes = {name: scored(study, args.workers) for name, study in studies.items()}
    scores = {name: outcome.after for name, outcome in outcomes.items()}
    figures = {n: each.key_figures(outcomes[n].figures_after) for n, each in studies.items()}
    rows = advice.compare(scores)
    figure_rows = advice.compare_figures(figures)
    first, *others = (study.vehicle for study in studies.values())
    alike = all(_same_body(first, other) for other in others)
    names = list(scores)
    models = ([sensor.model for sensor in study.rig] for study in studies.values())
    curves = advice.curve_note(studies.values())
    notes = [note for note in (advice.hardware_note(models), curves) if note]
    apart = advice.disagreement(names, [*rows, *figure_rows])
    worth = advice.worth_rows(
        next(iter(studies.values())), [study.rig for study in studies.values()], one_vehicle=alike
    )
    said = [*[apart] * bool(apart), *advice.ranking(names, rows)]
    said += advice.worth_lines(names, [*rows, *figure_rows], worth)
    lines = [*comparison(names, [*rows, *figure_rows]), *said]
    lines += [] if alike else ["their vehicles differ"]
    if error := max(score.stderr for score in scores.values()):
        lines.append(
            f"on samples: entropies have a standard error of up to {error_text(error)} nats; "
            "+- is that of a difference, smaller on a shared sample"
        )
    data = CompareAnswer(
        scores=scores,
        figures=figures,
        rows=tuple(row.to_dict() for row in (*rows, *figure_rows)),
        same_vehicle=alike,
        notes=tuple(notes),
        words=tuple(said),
    )
    return answered(args, data, [*lines, *notes]), DONE


def _showing_alike(studies: Mapping[str, Study]) -> dict[str, Study]:
    """Return the studies, each with the figures that any of them shows."""
    asked = {key for study in studies.values() for key in study.shown_figures}
    figures = tuple(key for key in SHOWN if key in asked)
    return {name: replace(study, figures=figures) for name, study in studies.items()}


def _beside(studies: Mapping[str, Study], key: str | None) -> dict[str, Study]:
    """Return the first study with a known rig instead of its own, by name; nothing without one."""
    if key is None:
        return {}
    known = catalog.known_rig(key)
    first = next(iter(studies.values()))
    name = key if key not in studies else f"known rig {key}"
    return {name: first.with_unrelated_rig(catalog.rig_on(known, first.vehicle))}


def scored(study: Study, workers: int | None, source: StudyFiles | None = None) -> Outcome:
    """Score a study, with progress and by the evaluators that its source keeps; Ctrl-C ends it."""
    print_vehicle(study)
    job = ScoreJob(study, workers)
    if source is not None:
        source.share_evaluators(job)
    with stop_at_first(job.stop) as received:
        outcome = drive(job)
    if outcome is None:
        raise Interrupted(received.signum or signal.SIGINT, "no score was complete")
    return outcome


def refuse_different(studies: Mapping[str, Study]) -> None:
    """Raise `InputError` for studies whose scores are not comparable (`COMPARED`)."""
    first, *others = studies.items()
    for name, study in others:
        for field in COMPARED:
            if getattr(study, field) != getattr(first[1], field):
                field = "AP curves and fusion" if field == "model" else field
                expected = f"the same as in {first[0]}, to be compared with it"
                raise InputError(name, field, expected, "another")

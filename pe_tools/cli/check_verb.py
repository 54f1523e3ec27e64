"""`pe check`: a study held to its requirements and scenarios; presets and shipped scenarios."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from pe_core.base import dump_json, record
from pe_core.base.errors import InputError
from pe_core.base.files import csv_text
from pe_core.base.table_reader import finite
from pe_core.motion import scenarios
from pe_core.scoring.requirements import Verdict, checkable
from pe_core.search import Limits
from pe_core.study import Study
from pe_core.study.requirement_file import CONFIDENCE, Preset, preset, presets
from pe_core.study.suggestion import Suggestion

from ..advice import curve_note
from ..jobs import CheckJob, SuggestJob
from ..wording import aligned, margin_text, percent, reason_text, unseen_text
from .answers import CheckAnswer, PresetsAnswer
from .interrupts import stop_at_first
from .run_job import drive, output_file, print_vehicle, save_text
from .scenario_text import chosen_scenarios, scenario_lines, scenario_names
from .study_source import StudyFiles
from .terminal import DONE, NOT_MET, Answer, answered, tell

STOPPED = "stopped before"  # Why a requirement has no verdict after Ctrl-C
ALL = "all"
CSV = ".csv"  # Suffix of a table of verdicts; another file has JSON
COLUMNS = (
    "name",
    "check",
    "met",
    "margin_m",
    "share",
    "worst_x",
    "worst_y",
    "worst_body",
    "seen_by",
    "unseen_by",
    "breaks_without",
    "blind_m2",
    "source",
)
LONGEST = 34  # Longer names are cut in the table


def check(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Hold a study to its requirements and scenarios; the exit status says whether all are met."""
    if args.list is not None:
        return list_checks(args)
    return check_study(source.study(args), args, source)


def list_checks(args: argparse.Namespace) -> Answer:
    """List requirement presets and shipped scenarios, or show one preset with its source."""
    chosen = [preset(args.list, "check", "--list")] if args.list else list(presets().values())
    shipped = {} if args.list else scenarios()
    rows = tuple({"id": p.id, "confidence": p.confidence, **p.table} for p in chosen)
    told = {name: {"title": s.title, "source": s.source} for name, s in shipped.items()}
    data = PresetsAnswer(rows, told)
    if args.list:
        return answered(args, data, _preset_lines(chosen[0])), DONE
    width = max(len(each.id) for each in chosen)
    lines = [f"{each.id:{width}}  {each.confidence}  {each.check}: {each.name}" for each in chosen]
    lines += [f"{letter}: {meaning}" for letter, meaning in CONFIDENCE.items()]
    lines += ["", *aligned([[name, s.title, s.source] for name, s in shipped.items()])]
    return answered(args, data, lines), DONE


def check_study(study: Study, args: argparse.Namespace, source: StudyFiles) -> Answer:
    """Hold a study to its requirements, scenarios and limits, and to the presets that are named;
    with
    ``--scenarios`` to scenarios alone. After Ctrl-C the verdicts that were found are printed, and
    written to the file."""
    if args.scenarios is not None:
        chosen = chosen_scenarios(study, scenario_names(args.scenarios))
        study = replace(study, requirements=(), scenarios=tuple(chosen), limits=Limits())
    output = output_file(args.output, args)
    study, unchecked = with_presets(study, args.preset)
    if not (study.requirements or study.scenarios or study.limits.with_number):
        expected = "[[requirement]], [[scenario]] or [limits] in the study, or --preset ID"
        raise InputError("check", "requirements", expected, "none")
    print_vehicle(study)
    if note := curve_note([study]):
        tell(note)
    job = CheckJob(study)
    source.share_evaluators(job)
    with stop_at_first(job.stop) as received:
        drive(job)
    verdicts = job.verdicts
    driven = job.driven
    met = all(v.met for v in verdicts) and all(each.is_met for each in driven)
    met = met and all(each.met for each in job.limits)
    status = received.status(DONE if met else NOT_MET)
    unchecked |= dict.fromkeys(job.missing, STOPPED)
    wanted = args.suggest and status == NOT_MET
    suggested = suggested_for(SuggestJob(study)) if wanted else {}
    data = CheckAnswer(
        met=sum(v.met for v in verdicts),
        requirements=tuple(v.row for v in verdicts),
        unchecked=unchecked,
        suggestions={n: tuple(each.to_dict() for each in own) for n, own in suggested.items()},
        scenarios=tuple(each.to_dict() for each in driven),
        limits=tuple(each.row for each in job.limits),
    )
    text = dump_json(finite(record(data)))
    is_table = output is not None and output.suffix == CSV
    status = save_text(output, verdicts_csv(verdicts) if is_table else text) or status
    if args.json:
        return text, status
    lines = verdict_lines(verdicts, unchecked) if verdicts or unchecked else []
    lines += scenario_lines(driven) if driven else []
    lines += [f"limit: {each.figure.name} {each.text}" for each in job.limits]
    lines += [line for name, own in suggested.items() for line in suggestion_lines(name, own)]
    return "\n".join(lines), status


def suggested_for(job: SuggestJob) -> dict[str, list[Suggestion]]:
    """Run a job that looks for what would fix something; nothing after Ctrl-C."""
    with stop_at_first(job.stop):
        drive(job)
    return job.found or {}


def suggestion_lines(name: str, found: Sequence[Suggestion]) -> list[str]:
    """Return what would fix something as lines: each with where the sensors would be."""
    none = "no move of one sensor, or linked pair, and no added one that was tried fixes it"
    return [f"{name}: {each.sentence} ({each.text})" for each in found] or [f"{name}: {none}"]


def with_presets(study: Study, names: Sequence[str]) -> tuple[Study, dict[str, str]]:
    """Return a study with presets added to its requirements, and those that cannot be checked. Of
    ``all`` presets those that cannot be placed round the vehicle are left out, with the reason."""
    named = [preset(name, "check", "--preset").id for name in names if name != ALL]
    own = {each.name for each in study.requirements}
    added = [presets()[name].requirement() for name in dict.fromkeys(named) if name not in own]
    unchecked: dict[str, str] = {}
    if ALL in names:
        rest = [each.requirement() for each in presets().values() if each.id not in own | {*named}]
        fitting, unchecked = checkable(
            rest, study.rig, study.vehicle, study.reference, space=study.space
        )
        added += fitting
    return replace(study, requirements=(*study.requirements, *added)), unchecked


def verdict_lines(verdicts: Sequence[Verdict], unchecked: dict[str, str]) -> list[str]:
    """Return verdicts as a table, with a line about each that is not met, and a summary."""
    rows = [("", "requirement", "after", "margin", "share", "what breaks or occludes it")]
    lines = aligned([*rows, *(_row(v) for v in verdicts)])
    lines += [f"{name}: not checked: {reason}" for name, reason in unchecked.items()]
    more = f", {len(unchecked)} not checked" if unchecked else ""
    lines.append(f"{sum(v.met for v in verdicts)} of {len(verdicts)} met{more}")
    if any(v.requirement.check for v in verdicts):
        lines.append("geometric checks after the texts named, no approval")
    return lines


def _row(verdict: Verdict) -> tuple[str, str, str, str, str, str]:
    name = verdict.name if len(verdict.name) <= LONGEST else verdict.name[: LONGEST - 3] + "..."
    margin = margin_text(verdict.summary)
    if verdict.margin is not None:
        blind = "" if verdict.blind_m2 is None else f"blind {verdict.blind_m2:.2f} m2, "
        margin = f"{blind}{'>= ' if verdict.at_least else ''}{verdict.margin:+.2f} m"
    met = "met" if verdict.met else "NOT MET"
    share = percent(verdict.share, 1)
    return met, name, verdict.requirement.after, margin, share, _reason(verdict)


def _reason(verdict: Verdict) -> str:
    """Return what breaks a requirement that is met, or what hides the worst place of another."""
    broken = ", ".join(verdict.breaks_without)
    if verdict.met_whole:
        how = "breaks without" if verdict.met else "met, but not without"
        off = "" if verdict.met else "met, but not with mounting errors"
        return f"{how} {broken}" if broken else off
    if verdict.worst is None:
        return ""
    x, y = verdict.worst
    unseen = unseen_text(verdict.unseen_by)
    what = f"{verdict.body or 'nearest blind ground'} at "
    return f"{what}({x:.2f}, {y:.2f}){f': {unseen}' if unseen else ''}"


def verdicts_csv(verdicts: Sequence[Verdict]) -> str:
    """Return verdicts as CSV, a row each."""
    rows: list[list[object]] = [[*COLUMNS]]
    for verdict in verdicts:
        x, y = verdict.worst or ("", "")
        data = record(verdict.row)
        listed = {
            "worst_x": x,
            "worst_y": y,
            "seen_by": "; ".join(verdict.seen_by),
            "unseen_by": "; ".join(f"{k}: {reason_text(v)}" for k, v in verdict.unseen_by.items()),
            "breaks_without": "; ".join(verdict.breaks_without),
        }
        rows.append([(data | listed)[c] for c in COLUMNS])
    return csv_text(rows)


def _preset_lines(each: Preset) -> list[str]:
    lines = [f"{each.id}: {each.check}, {each.name}"]
    rows = {"confidence": f"{each.confidence}: {CONFIDENCE[each.confidence]}"}
    rows |= {k: _shown(v) for k, v in each.table.items() if k not in ("name", "check", "source")}
    return lines + [f"{key:15} {text}" for key, text in {**rows, "source": each.source}.items()]


def _shown(value: Any) -> str:
    if isinstance(value, dict):
        return "; ".join(f"{key} {_shown(item)}" for key, item in value.items())
    if isinstance(value, list):
        return ", ".join(f"({_shown(v)})" if isinstance(v, list) else str(v) for v in value)
    return str(value)

"""Options of `pe optimize` that say when to stop, what stays, from where, and for what."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from pe_core.base.files import quoted
from pe_core.scene.rig import Rig
from pe_core.search.goals import FULL, OBJECTIVES, OFF, Front, Goals, Start, Stop
from pe_core.study import Study, load_study

AUTO = "auto"
"""Value of `--sensitivity` that leaves the study's own."""
KEEP, ANY = "keep", "any"
"""Values of `--blind-ground`: the study's key, or none."""


def add_goal_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a search's goals to a parser."""
    real = _number()
    parser.add_argument(
        "--stop-at", type=real, metavar="VALUE", help="end at this entropy (or AP), or a better one"
    )
    parser.add_argument("--stop-after", type=real, metavar="S", help="end after so many seconds")
    about = "end when the last placements gained less than this"
    parser.add_argument("--stop-gain", type=real, metavar="VALUE", help=about)
    about = "sensors that stay where they are, besides those of the study"
    parser.add_argument("--fix", type=_names, metavar="NAME,...", help=about)
    about = "start from the placement of this study, too; any number"
    parser.add_argument("--start", action="append", metavar="STUDY", help=about)
    about = f"a Pareto front of these: two or more of {', '.join(OBJECTIVES)}"
    parser.add_argument("--front", type=_names, metavar="NAME,...", help=about)
    about = "keep: no more blind ground than the start; any: as much as the search likes"
    parser.add_argument("--blind-ground", choices=(KEEP, ANY), metavar="keep|any", help=about)
    about = "how sure the result is: as far as an eighth of the evaluations goes, all of it, or off"
    parser.add_argument(
        "--sensitivity", choices=(AUTO, FULL, OFF), metavar="auto|full|off", help=about
    )


def with_goals(study: Study, args: argparse.Namespace) -> Study:
    """Return the study with the changes of these options; `InputError` for an impossible one."""
    search = study.search
    goals = _with_starts(_with_stop(search.goals, args), args)
    if (names := getattr(args, "fix", None)) is not None:
        goals = replace(goals, fixed=tuple(dict.fromkeys((*goals.fixed, *names))))
    if (names := getattr(args, "front", None)) is not None:
        goals = replace(goals, front=Front(names, goals.front.points))
    if (wanted := getattr(args, "sensitivity", None)) not in (None, AUTO):
        goals = replace(goals, sensitivity=wanted)
    if (wanted := getattr(args, "blind_ground", None)) is not None:
        goals = replace(goals, blind_ground=KEEP if wanted == KEEP else None)
    if goals == search.goals:
        return study
    changed = replace(study, search=replace(search, goals=goals))
    changed.coding()  # a follower that is to stay is bad input, not a late surprise
    return changed


def _with_stop(goals: Goals, args: argparse.Namespace) -> Goals:
    options = {"target": "stop_at", "seconds": "stop_after", "gain": "stop_gain"}
    values = {name: getattr(args, option, None) for name, option in options.items()}
    given = {name: value for name, value in values.items() if value is not None}
    if not given:
        return goals
    own = goals.stop
    now = {"target": own.target, "seconds": own.seconds, "gain": own.gain, **given}
    return replace(goals, stop=Stop(now["target"], now["seconds"], now["gain"], own.over))


def _with_starts(goals: Goals, args: argparse.Namespace) -> Goals:
    paths = getattr(args, "start", None) or ()
    starts = [start_of(Path(path).stem, load_study(path).rig) for path in paths]
    return replace(goals, starts=(*goals.starts, *starts)) if starts else goals


def start_of(name: str, rig: Rig) -> Start:
    """Return a rig as a start of a search."""
    return Start(name, {sensor.name: sensor.pose for sensor in rig})


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _number() -> Callable[[str], float]:
    def number(text: str) -> float:
        try:
            return float(text)
        except ValueError:
            expected = f"expected a number, found {quoted(text)}"
            raise argparse.ArgumentTypeError(expected) from None

    return number

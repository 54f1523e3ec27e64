"""Options of `pe optimize` that say when to stop, what stays, from where, and for what."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from pe_core.base.files import quoted
from pe_core.search.goals import FULL, OBJECTIVES, OFF, Front, Start
from pe_core.study import Study, load_study

AUTO = "auto"
"""Value of `--sensitivity` that leaves the study's own."""
KEEP, ANY = "keep", "any"
"""Values of `--blind-ground`: the study's key, or none."""
STOPS = {"stop_at": "target", "stop_after": "seconds", "stop_gain": "gain"}
"""Fields of `Stop` by option."""


def add_goal_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a search's goals to a parser."""
    add = parser.add_argument
    about = "end at this entropy (or AP), or a better one"
    add("--stop-at", type=_number, metavar="VALUE", help=about)
    add("--stop-after", type=_number, metavar="S", help="end after so many seconds")
    about = "end when the last placements gained less than this"
    add("--stop-gain", type=_number, metavar="VALUE", help=about)
    about = "sensors that stay where they are, besides those of the study"
    add("--fix", type=_names, default=(), metavar="NAME,...", help=about)
    about = "start from the placement of this study, too; any number"
    add("--start", action="append", default=[], metavar="STUDY", help=about)
    about = f"a Pareto front of these: two or more of {', '.join(OBJECTIVES)}"
    add("--front", type=_names, metavar="NAME,...", help=about)
    about = "keep: no more blind ground than the start; any: as much as the search likes"
    add("--blind-ground", choices=(KEEP, ANY), metavar="keep|any", help=about)
    about = "how sure the result is: as far as an eighth of the evaluations goes, all of it, or off"
    add("--sensitivity", choices=(AUTO, FULL, OFF), metavar="auto|full|off", help=about)


def with_goals(study: Study, args: argparse.Namespace) -> Study:
    """Return the study with the changes of these options; `InputError` for an impossible one.

    A verb that does not search has none of them.
    """
    goals = own = study.search.goals
    given = {field: getattr(args, option, None) for option, field in STOPS.items()}
    stops = {field: value for field, value in given.items() if value is not None}
    goals = replace(goals, stop=replace(goals.stop, **stops)) if stops else goals
    rigs = [(Path(path).stem, load_study(path).rig) for path in getattr(args, "start", ())]
    starts = [Start(name, {s.name: s.pose for s in rig}) for name, rig in rigs]
    goals = replace(goals, starts=(*goals.starts, *starts)) if starts else goals
    if names := getattr(args, "fix", ()):
        goals = replace(goals, fixed=tuple(dict.fromkeys((*goals.fixed, *names))))
    if (names := getattr(args, "front", None)) is not None:
        goals = replace(goals, front=Front(names, goals.front.points))
    if (wanted := getattr(args, "sensitivity", None)) not in (None, AUTO):
        goals = replace(goals, sensitivity=wanted)
    if (wanted := getattr(args, "blind_ground", None)) is not None:
        goals = replace(goals, blind_ground=KEEP if wanted == KEEP else None)
    if goals == own:
        return study
    changed = replace(study, search=replace(study.search, goals=goals))
    changed.coding()  # a follower that is to stay is bad input, not a late surprise
    return changed


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        expected = f"expected a number, found {quoted(text)}"
        raise argparse.ArgumentTypeError(expected) from None

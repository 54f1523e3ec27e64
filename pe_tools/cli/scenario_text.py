"""Scenarios in the command: those that are named, and when their tracks are confirmed."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text, read_bytes
from pe_core.base.table_reader import load_toml
from pe_core.base.values import choice
from pe_core.motion import DriveBy, Scenario, SeenBody, scenarios
from pe_core.scoring.sight import shown_end, shown_start
from pe_core.study import Node, Study, read

from ..wording import aligned

ALL = "all"
TOML = ".toml"


@dataclass(frozen=True)
class ScenarioFile:
    """A file of scenarios."""

    scenario: tuple[Scenario, ...]


def scenario_names(text: str | None) -> list[str]:
    """Return the names of the option ``--scenarios``: none where it is left out, or has none."""
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def chosen_scenarios(study: Study, names: Sequence[str]) -> list[Scenario]:
    """Return scenarios by name or from files; without names the study's own. `InputError` for none,
    and for a name that no scenario has."""
    known = {**scenarios(), **{scenario.name: scenario for scenario in study.scenarios}}
    chosen: dict[str, Scenario] = (
        {} if names else {scenario.name: scenario for scenario in study.scenarios}
    )
    for name in names:
        if name == ALL:
            chosen |= scenarios()
        elif name.endswith(TOML):
            tables = load_toml(name, "scenarios", decode_text(read_bytes(Path(name))))
            chosen |= {
                scenario.name: scenario
                for scenario in read(ScenarioFile, Node(tables, name)).scenario
            }
        else:
            chosen[name] = known[choice("check", "--scenarios", name, tuple(known))]
    if not chosen:
        expected = "[[scenario]] in the study, or --scenarios NAME (--list lists them)"
        raise InputError("check", "scenarios", expected, "none")
    return list(chosen.values())


def scenario_lines(driven: Sequence[DriveBy]) -> list[str]:
    """Return scenarios as a table: a row for each watched body."""
    bodies = [body for each in driven for body in each.bodies]
    chances = sorted({chance for body in bodies for chance in body.moments})
    head = ["", "scenario", "body", *(f"confirmed {c:.0%}" for c in chances), "lost", "margin"]
    head += ["stops in"]
    rows = [[*_row(each, body, chances)] for each in driven for body in each.bodies]
    met = sum(each.is_met for each in driven)
    return [*aligned([head, *rows]), f"{met} of {len(driven)} scenarios confirmed in time"]


def _row(driven: DriveBy, body: SeenBody, chances: Sequence[float]) -> list[str]:
    texts = [
        "never" if m is None else f"{shown_end(m.time_s):+.1f} s, {shown_start(m.distance_m):.1f} m"
        for m in map(body.moments.get, chances)
    ]
    margin = "-" if body.margin_s is None else f"{body.shown_margin_s:+.1f} s"
    met = "met" if body.is_met else "NOT MET"
    lost = f"{shown_end(body.lost_s):.1f} s"
    stop = f"{shown_end(driven.scenario.stop_m):.1f} m"
    return [met, driven.scenario.name, body.name, *texts, lost, margin, stop]

#!/usr/bin/env python3
"""Make the projects of examples/ again: vehicles, searches, figures, pages, .blend, pictures.

usage: tools/examples.py [--pages] [NAME ...]

A project is a folder with numbered studies: what was tried. A search from the last one finds what
was decided. Figures of all are kept in figures.json; the pages of docs/examples have them between
marks, ``<!--=decided.entropy-->1.23<!--/-->``, and are written again with new figures. The mesh and
the .blend are made with bpy 4.2, which is installed below ~/.cache if it is not there.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

import release  # noqa: E402

import pe_core as pe  # noqa: E402
import pe_tools as pt  # noqa: E402
from pe_tools import advice  # noqa: E402
from pe_tools.page import ReportContext, page_bytes  # noqa: E402
from pe_tools.page.document import STYLES  # noqa: E402
from pe_tools.page.pictures.sight_plans import requirement_plan  # noqa: E402
from pe_tools.page.pictures.vehicle_picture import vehicle_picture  # noqa: E402
from pe_tools.wording import verdict_text  # noqa: E402

FOLDER = ROOT / "examples"
PAGES = ROOT / "docs" / "examples"
IMAGES = ROOT / "docs" / "images"
SHOWN = {
    "robotaxi_sedan": "child beside the doors",
    "delivery_shuttle": "child at the door",
    "city_bus": "child at the doors",
    "truck_trailer": "cyclist beside the trailer",
}
"""The projects, and the requirement whose plan is on the page, before and after."""
PICTURE_PX = (960, 480)
DECIDED = "decided.toml"
FIGURES = "figures.json"
RESULT = "review.html"
CLASS = "pedestrian"
MARK = re.compile(r"(<!--=([\w., ]+)-->)(.*?)(<!--/-->)", re.DOTALL)
Values = dict[str, str]


@dataclass(frozen=True)
class Result:
    """A study with its score and verdicts."""

    name: str
    study: pe.Study
    outcome: pt.Outcome
    verdicts: tuple[pe.requirements.Verdict, ...]

    @property
    def met(self) -> int:
        """How many requirements are met."""
        return sum(verdict.met for verdict in self.verdicts)


def tried(name: str) -> list[Path]:
    """Return the numbered studies of a project, in their order."""
    return sorted((FOLDER / name).glob("[0-9]*.toml"))


def studies_of(name: str) -> list[Path]:
    """Return all studies of a project: what was tried, and what was decided."""
    return [*tried(name), FOLDER / name / DECIDED]


def scored(path: Path) -> Result:
    """Score a study and hold it to its requirements."""
    study = pe.load_study(path)
    return Result(path.stem, study, outcome_of(pt.ScoreJob(study)), verdicts_of(study))


def verdicts_of(study: pe.Study) -> tuple[pe.requirements.Verdict, ...]:
    """Return the verdicts of a study's rig."""
    return tuple(study.checker().check(study.rig))


def outcome_of(job: pt.Job) -> pt.Outcome:
    """Drive a job to its end."""
    for _ in job:
        pass
    return job.outcome


def decide(name: str) -> pt.Outcome:
    """Search from the last study, and write what is decided."""
    last = pe.load_study(tried(name)[-1])
    outcome = outcome_of(pt.OptimizeJob(last, workers=1))
    write_decided(name, outcome.study)
    return outcome


def write_decided(name: str, study: pe.Study) -> None:
    """Write the study that was decided, beside the mesh of the others."""
    path = FOLDER / name / DECIDED
    path.unlink(missing_ok=True)
    pe.save_study(study.with_mesh("vehicle.npz"), path)
    head = (
        "# What was decided: written by tools/examples.py from the last of the other studies.\n\n"
    )
    path.write_text(head + path.read_text("utf-8"), "utf-8")


def figures_of(result: Result) -> Values:
    """Return the figures of a study as the page has them, by name."""
    score = result.outcome.after
    study = result.study
    sight = study.sight()
    key = advice.KeyFigures.of_rig(sight, study.rig)
    values = {
        "sensors": sensors_text(study.rig),
        "entropy": f"{score.entropy:.3f}",
        "stderr": f"{max(score.stderr, 1e-3):.3f}",
        "coverage": f"{100.0 * score.coverage:.1f} %",
        "met": f"{result.met} of {len(result.verdicts)}",
        "ap": f"{key.values['traffic_ap']:.3f}",
        "blind": f"{math.ceil(10.0 * key.values['blind_ground']) / 10.0:.1f} m²",
        "reach": f"{math.floor(key.reach[CLASS][0])} m",
    }
    for verdict in result.verdicts:
        name = verdict.requirement.name
        values[f"verdict {name}"] = "met" if verdict.met else "not met"
    return values


def in_states(result: Result) -> Iterator[Result]:
    """Yield the study's results in each of its states that moves parts, with their sensors."""
    study = result.study
    for state in study.conditions.states:
        if not state.motions:
            continue  # as drawn: the result itself
        moved = study.under(study.conditions.one(state.name))
        outcome = outcome_of(pt.ScoreJob(moved))
        yield Result(f"{result.name}, {state.name}", moved, outcome, verdicts_of(moved))


def sensors_text(rig: pe.Rig) -> str:
    """Return how many sensors of each model a rig has."""
    models = [sensor.model.name for sensor in rig]
    return ", ".join(f"{models.count(model)} x {model}" for model in dict.fromkeys(models))


def figures(name: str) -> dict[str, Values]:
    """Compute the figures of all studies of a project, by the study's name."""
    made = {}
    for path in studies_of(name):
        result = scored(path)
        made |= {each.name: figures_of(each) for each in (result, *in_states(result))}
    made[DECIDED.removesuffix(".toml")]["ap_change"] = ap_change(name)
    return made


def ap_change(name: str) -> str:
    """Return by how much what was decided changes the expected AP in traffic, with its error."""
    paths = tried(name)[-1], FOLDER / name / DECIDED
    studies = {path.stem: pe.load_study(path) for path in paths}
    keys = {
        stem: advice.KeyFigures.of_rig(study.sight(), study.rig) for stem, study in studies.items()
    }
    return advice.compare_figures(keys)[0].change_text(1, "±")


def table(values: dict[str, Values]) -> str:
    """Return the table of a project's studies."""
    head = (
        "study",
        "sensors",
        "entropy",
        "coverage",
        "AP in traffic",
        "blind ground",
        "requirements met",
    )
    rows = [
        (f"`{study}`", own["sensors"], f"{own['entropy']}&nbsp;±&nbsp;{own['stderr']}",
         own["coverage"], own["ap"], own["blind"], own["met"])
        for study, own in values.items()
    ]  # fmt: skip
    lines = [f"| {' | '.join(cells)} |" for cells in (head, ("---",) * len(head), *rows)]
    return "\n\n" + "\n".join(lines) + "\n\n"


def with_figures(text: str, values: dict[str, Values]) -> str:
    """Return a page's text with the figures between its marks."""

    def figure(found: re.Match[str]) -> str:
        key = found[2]
        study, _, name = key.rpartition(".")
        return f"{found[1]}{table(values) if key == 'table' else values[study][name]}{found[4]}"

    return MARK.sub(figure, text)


def plan(study: pe.Study, name: str) -> str:
    """Return the plan of a requirement of a study, as SVG on its own."""
    asked = tuple(each for each in study.requirements if each.name == name)
    (verdict,) = verdicts_of(replace(study, requirements=asked))
    drawn = str(
        requirement_plan(verdict, study.vehicle, f"{name}: {verdict_text(verdict.summary)}")
    )
    style = (STYLES / "drawn.css").read_text("utf-8")
    head = f'<svg xmlns="http://www.w3.org/2000/svg" style="background:#fff"><style>{style}</style>'
    return re.sub(r"^<svg (.*?)>", lambda f: head.replace("<svg ", f"<svg {f[1]} ", 1), drawn)


def draw(name: str) -> None:
    """Write the pictures of a project's page."""
    last = pe.load_study(FOLDER / name / DECIDED)
    first = pe.load_study(tried(name)[0])
    png = vehicle_picture(last.vehicle, last.rig, PICTURE_PX)
    (IMAGES / f"example_{name}.png").write_bytes(png)
    for which, study in (("before", first), ("after", last)):
        (IMAGES / f"example_{name}_{which}.svg").write_text(plan(study, SHOWN[name]), "utf-8")


def in_blender(what: str, name: str) -> None:
    """Make a file of a project with bpy 4.2: later versions read its files."""
    command = [release.install_bpy("4.2"), ROOT / "blend_assets" / "make_example.py", what, name]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=release.TIMEOUT_S)


def tell(name: str) -> None:
    """Write the page of a project again with the figures that are kept."""
    kept = json.loads((FOLDER / name / FIGURES).read_text("utf-8"))
    told = PAGES / f"{name}.md"
    told.write_text(with_figures(told.read_text("utf-8"), kept), "utf-8")


def make(name: str) -> None:
    """Make a project again."""
    in_blender("vehicle", name)
    outcome = decide(name)
    made = figures(name)
    text = json.dumps(made, indent=2, ensure_ascii=False)
    (FOLDER / name / FIGURES).write_text(text + "\n", "utf-8")
    command = f"pe optimize examples/{name}/{tried(name)[-1].name} -o results"
    page = page_bytes([ReportContext(name.replace("_", " "), outcome, command=command)])
    (FOLDER / name / RESULT).write_bytes(page)
    draw(name)
    in_blender("blend", name)
    tell(name)
    print(f"examples: {name}: decided, {made['decided']['met']} requirements met", flush=True)


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", choices=[*SHOWN, []], help="projects (default: all)")
    parser.add_argument("--pages", action="store_true", help="only the pages, from kept figures")
    given = parser.parse_args()
    for name in given.names or SHOWN:
        (tell if given.pages else make)(name)
    return 0


if __name__ == "__main__":
    sys.exit(main())

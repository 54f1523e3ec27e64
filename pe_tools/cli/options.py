"""All options of the command line, a row each. A verb names the rows that it takes; what repeats a
key of the study is no option: ``--set`` changes every key, and some keys have short names."""

import argparse
import json
from collections.abc import Callable
from functools import cache, partial
from typing import Any, NamedTuple

from pe_core.base.files import quoted

MAX_WORKERS = 1024
"""More threads or processes than anyone has a use for."""
MAX_PLACES = 20_000
MAX_PARTS = 1_000_000
LINE = "line"
"""Format of ``export`` that is one line to send, printed where no file is named."""
PLACEMENTS = ("published", "stretched", "places")
"""How a known rig stands on another vehicle: as published, about the vehicle's centre; its box
stretched onto the vehicle's; or each sensor on the nearest named place."""
A_LIST = "NAME,..."
SHORT = {
    "samples": ("samples", "N", "voxels that a score evaluates (0: all)"),
    "figures": ("figures", A_LIST, "key figures that are computed and shown"),
    "evaluations": ("optimize.evaluations", "N", "most placements to evaluate (0: the method's)"),
    "seed": ("optimize.seed", "N", "seed of the search"),
    "method": ("optimize.method", "NAME", "how to search: portfolio or random"),
}
"""Keys of the study with an option of their own: key, form of the value, meaning."""


def as_change(key: str, form: str, text: str) -> str:
    """Return the value of an option in `SHORT` as it is typed with ``--set``."""
    names = [name.strip() for name in text.split(",") if name.strip()]
    return f"{key}={json.dumps(names) if form == A_LIST else text}"


class LastOfKey(argparse.Action):
    """Adds ``KEY=VALUE`` to a list, in place of an earlier value of the same key."""

    def __call__(self, _parser: Any, namespace: Any, values: Any, _flag: str | None = None) -> None:
        """Add a value."""
        key = values.partition("=")[0]
        others = [each for each in getattr(namespace, self.dest) if each.partition("=")[0] != key]
        setattr(namespace, self.dest, [*others, values])


class OptionRow(NamedTuple):
    """An option: its flags, its meaning, and further arguments of `add_argument`."""

    flags: tuple[str, ...]
    about: str
    arguments: dict[str, Any]

    def add(self, parser: Any) -> None:
        """Add the option to a parser, or to a group of one."""
        parser.add_argument(*self.flags, help=self.about, **self.arguments)


def row(*flags: str, about: str, **arguments: Any) -> OptionRow:
    """Return an option."""
    return OptionRow(flags, about, arguments)


def switch(flag: str, about: str) -> OptionRow:
    """Return an option without a value."""
    return row(flag, about=about, action="store_true")


def several(*flags: str, about: str, **arguments: Any) -> OptionRow:
    """Return an option that may be given any number of times."""
    return row(*flags, about=about, action="append", default=[], **arguments)


def whole(greatest: int, least: int = 0) -> Callable[[str], int]:
    """Return a function that parses a whole number from `least` to `greatest`."""

    def count(text: str) -> int:
        digits = text.isascii() and text.isdecimal() and len(text) <= len(str(greatest))
        if not digits or not least <= int(text) <= greatest:
            expected = f"expected a whole number from {least} to {greatest}, found {quoted(text)}"
            raise argparse.ArgumentTypeError(expected)
        return int(text)

    return count


def number(text: str) -> float:
    """Return the number of an option."""
    try:
        return float(text)
    except ValueError:
        expected = f"expected a number, found {quoted(text)}"
        raise argparse.ArgumentTypeError(expected) from None


def part_of(text: str) -> tuple[int, int]:
    """Return K and N of "K/N", 1 to N; `argparse.ArgumentTypeError` for another text."""
    k, slash, n = text.partition("/")
    if slash and k.isdecimal() and n.isdecimal() and 1 <= int(k) <= int(n) <= MAX_PARTS:
        return int(k), int(n)
    raise argparse.ArgumentTypeError(f"expected K/N, as 3/40, found {text!r}")


def ranged_outputs() -> list[str]:
    """Return the outputs that draw fields of view, as far as asked for."""
    from ..outputs import scene_outputs

    return [output.name for output in scene_outputs().values() if output.has_range]


def add_options(parser: argparse.ArgumentParser, names: str) -> None:
    """Add options to a parser: names of rows, with a bar between those that exclude each other."""
    for name in names.split():
        one_of = name.split("|")
        to = parser.add_mutually_exclusive_group() if len(one_of) > 1 else parser
        for each in one_of:
            option(each).add(to)


def option(name: str) -> OptionRow:
    """Return an option by the name that verbs have for it. Groups are looked into in turn: the
    later ones have to load what they list."""
    groups = (_of_studies, _of_results, _of_pages, _of_questions, _of_places, _of_exchange)
    return next(rows[name] for rows in (group() for group in groups) if name in rows)


@cache
def _of_studies() -> dict[str, OptionRow]:
    """What is scored, and who works."""
    change = "sensor.roof.model=Pandar64: a value of TOML, or a text without quotes"
    found = "vehicle.up=+y, vehicle.forward=-x, vehicle.scale=0.0254, sensor.roof.model=NAME"
    set_key = "KEY=VALUE: change a key of the study, as `pe set` does; any number"
    tried = "KEY=VALUE,VALUE: values to try of a key of the study; several keys: every combination"
    condition = "a state, a weather, or both with a comma: scored alone"
    workers = "threads of a score, processes of a search (default: all)"
    who = "who works: dask://HOST:PORT, or MODULE:FUNCTION that returns an executor"
    start = "start from the placement of this study, too; any number"
    snap = "begin with each sensor on its mount: one that is not takes the nearest pose there"
    rows = {
        "changes": row("changes", nargs="+", metavar="KEY=VALUE", about=change),
        "set": several("--set", metavar="KEY=VALUE", about=set_key),
        "try": several("--set", metavar="KEY=VALUE,...", about=tried),
        "set_found": several("--set", metavar="KEY=VALUE", about=f"what is not found: {found}"),
        "condition": row("--condition", metavar="NAME", about=condition),
        "workers": row("--workers", type=whole(MAX_WORKERS), metavar="N", about=workers),
        "executor": row("--executor", metavar="WHO", about=who),
        "start": several("--start", metavar="STUDY", about=start),
        "snap": switch("--snap", snap),
    }
    for name, (key, form, about) in SHORT.items():
        meant = f"{about}; as --set {key}={f'[{form}]' if form == A_LIST else form}"
        typed = partial(as_change, key, form)
        rows[name] = row(
            f"--{name}",
            about=meant,
            action=LastOfKey,
            default=[],
            dest="set",
            type=typed,
            metavar=form,
        )
    return rows


@cache
def _of_results() -> dict[str, OptionRow]:
    """Where results go."""
    resume = "go on with the search that was begun in this folder"
    part = "only these runs, the K-th of N parts, without a table: for array jobs of a cluster"
    return {
        "folder": row("-o", "--output", metavar="DIR", about="folder for the results"),
        "required_folder": row(
            "-o", "--output", required=True, metavar="DIR", about="folder for the results"
        ),
        "file": row("-o", "--output", metavar="FILE", about="file for the table (.csv) or JSON"),
        "study_file": row("-o", "--output", metavar="STUDY", about="study to write"),
        "region_file": row(
            "-o",
            "--output",
            metavar="FILE",
            about="patch (.stl .glb .obj .npz), all data (.json), or the next study on it (.toml)",
        ),
        "resume": row("--resume", metavar="DIR", about=resume),
        "json": switch("--json", "print JSON"),
        "replace": switch("--replace", "replace files that are there"),
        "no_review": row("--no-review", dest="review", action="store_false", about="no page"),
        "optimize": switch("--optimize", "search in every run; else score"),
        "part": row("--part", type=part_of, metavar="K/N", about=part),
    }


@cache
def _of_questions() -> dict[str, OptionRow]:
    """What is asked about a rig."""
    at = "ask one place instead: x, y and perhaps z (else 0) in metres"
    steepest = "where this sensor gains most: along its surface, turned, and within 20 cm"
    measured = "with --sensor: how far it is from these edges of the vehicle; none: list the edges"
    suggest = "say which small move, or one more sensor, would fix what is not seen"
    body = "with --at: a test body there (child, adult, cyclist, car, pole, cone ...): m by sensor"
    preset = "a preset besides the study's requirements (--list); all: each one; any number"
    listed = "list requirement presets and scenarios, or show one preset"
    scenarios = (
        "scenarios alone: the study's; or by name, of a TOML file, all shipped (all); commas"
    )
    return {
        "at": row("--at", type=number, nargs="+", metavar=("X Y", "Z"), about=at),
        "suggest": switch("--suggest", suggest),
        "of_sensor": row("--sensor", dest="of_sensor", metavar="NAME", about=steepest),
        "measured_from": row(
            "--from", dest="measured_from", nargs="*", metavar="EDGE", about=measured
        ),
        "body": row("--body", metavar="NAME", about=body),
        "heading": row(
            "--heading", type=number, metavar="DEG", about="with --body: its heading, to the left"
        ),
        "class": row(
            "--class", dest="class_name", metavar="NAME", about="class whose reach is told"
        ),
        "preset": several("--preset", metavar="ID", about=preset),
        "list": row("--list", nargs="?", const="", metavar="ID", about=listed),
        "scenarios": row("--scenarios", nargs="?", const="", metavar="NAME,...", about=scenarios),
        "built": row(
            "--built",
            metavar="FILE",
            about="compare the built rig in this file of another program with the design",
        ),
        "beside": row(
            "--beside", metavar="RIG", about="a known rig on the first one's vehicle, too"
        ),
        "model": row(
            "--model", required=True, metavar="NAME", about="the sensor's model (pe sensors)"
        ),
        "sensor_name": row("name", nargs="?", metavar="NAME", about="a sensor of the catalogue"),
        "curves": switch("--curves", "list the AP curves of whole objects, by model"),
    }


@cache
def _of_places() -> dict[str, OptionRow]:
    """Where a sensor may go."""
    from ..advice import usual_loss
    from ..jobs import PLACE_FIGURES

    places = ", ".join(f"{key} {each.places:,}" for key, each in PLACE_FIGURES.items())
    figures = {"choices": PLACE_FIGURES, "default": "entropy", "metavar": "|".join(PLACE_FIGURES)}
    losses = ", ".join(f"{key} {usual_loss(each.figure):g}" for key, each in PLACE_FIGURES.items())
    mount = "a mount of the study: its surface, stand-off and orientation"
    part = "a part of the vehicle, in place of all; any number"
    return {
        "of_part": several("--part", metavar="NAME", about=part),
        "mount": row("--mount", default="", metavar="NAME", about=mount),
        "figure": row("--figure", about="what is told of each place", **figures),
        "sensor": row("sensor", metavar="SENSOR", about="the sensor that moves"),
        "loss": row(
            "--loss", type=number, metavar="D", about=f"how much the figure may lose ({losses})"
        ),
        "others": switch("--others", "search the other sensors again at places outside, too"),
        "places": row(
            "--places", type=whole(MAX_PLACES, 1), metavar="N", about=f"how many ({places})"
        ),
    }


@cache
def _of_exchange() -> dict[str, OptionRow]:
    """Rigs of other programs and known vehicles."""
    from ..exchange import RIG_FORMATS
    from ..outputs import OF_EXAMPLE, scene_outputs

    formats = [*RIG_FORMATS, *dict.fromkeys([*scene_outputs(), *OF_EXAMPLE]), LINE]
    to = f"format: {', '.join(formats)} (default: by the suffix of PATH)"
    read = f"its format, if its name does not tell: {', '.join(RIG_FORMATS)}"
    out = "file, or folder for a format of several files (default: that of --into)"
    into = "file that the rig goes into: all that is not about its sensors stays"
    far = f"of {', '.join(ranged_outputs())}: how far sensors are drawn [m] (default: their range)"
    axle = "its middle: X Z [m], Autoware's vehicle_info.param.yaml, or wheels, to guess it"
    model = "a sensor's model, which the file does not tell; any number"
    at = "where the file's origin is: x y z in m, roll pitch yaw in degrees"
    mesh = "the vehicle's mesh, from the study's folder"
    rig = "a known rig or template in place of a first sensor, or a rig's line; alone: list them"
    placement = "of a known rig: as published, stretched onto the vehicle, or on named places"
    return {
        "to": row("--to", choices=formats, metavar="FORMAT", about=to),
        "path": row("-o", "--output", metavar="PATH", about=out),
        "into": row("--into", metavar="PATH", about=into),
        "range": row("--range", type=number, metavar="M", about=far),
        "rear_axle": row("--rear-axle", nargs="+", metavar=("X|FILE|wheels", "Z"), about=axle),
        "from": row("--from", dest="format", choices=RIG_FORMATS, metavar="FORMAT", about=read),
        "models": several("--model", metavar="NAME=MODEL", about=model),
        "origin": row(
            "--at", type=number, nargs=6, metavar=("X", "Y", "Z", "R", "P", "W"), about=at
        ),
        "mesh": row("--mesh", metavar="FILE", about=mesh),
        "foreign_file": row("file", metavar="FILE", about="file or folder of another program"),
        "mesh_file": row(
            "file", nargs="?", metavar="MESH", about="mesh: .glb, .obj, .stl, .ply, .npz, ..."
        ),
        "rig": row("--rig", nargs="?", const="", metavar="NAME", about=rig),
        "placement": row(
            "--placement", choices=PLACEMENTS, metavar="|".join(PLACEMENTS), about=placement
        ),
    }


@cache
def _of_pages() -> dict[str, OptionRow]:
    """What stands on a review page."""
    return {
        "regions": several(
            "--region", metavar="SENSOR", about="show where this sensor may go; any number"
        ),
        "title": row("--title", default="", metavar="TEXT", about="title of the page"),
        "author": row("--author", default="", metavar="TEXT", about="who made it"),
        "date": row(
            "--date", default="", metavar="TEXT", about="date on the page; 'today': of the run"
        ),
        "revision": row("--revision", default="", metavar="TEXT", about="revision of the page"),
    }

"""The codec by hand: a tree of toy dataclasses as plain data, back, and refused with a path."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

import jsonschema
import pytest

import pe_core as pe
from pe_core.base.codec import Node, declared, read, write
from pe_core.base.json_schema import schema_of
from pe_core.base.setting import Named, Part, check_settings, setting
from pe_core.base.values import Angle, Number

LENGTH = Number(0.0, 10.0, unit="m")
DATA = {
    "plate": [{"name": "a", "layers": 3, "hole": [{"radius": 1.5}]}, {"name": "b"}],
    "tile": [
        {"name": "disc", "radius": 2.0},
        {"name": "turned", "side": 1.0, "turn_deg": 30.0},
        {"name": "flat", "side": 2.0},
    ],
    "weights": {"oak": 0.5},
    "corner": [1.0, -2.0],
}
BAD = [
    ("document", [], "a table"),
    ("plate", {"plate": {}}, "an array"),
    ("plate[1].name", {"plate": [{"name": "a"}, {}]}, "a value"),
    ("plate[0].nam", {"plate": [{"nam": "a"}]}, "name, or"),
    ("plate[0].hole[0].radius", {"plate": [{"name": "a", "hole": [{"radius": 11}]}]}, "10"),
    ("plate[0].layers", {"plate": [{"name": "a", "layers": 4}]}, "another number"),
    ("tile[1].name", {"tile": [{"name": "a", "side": 1}] * 2}, "each name once"),
    ("tile[0].turn_deg", {"tile": [{"name": "a", "side": 1, "turn_deg": 91}]}, "90 degrees"),
    ("tile[0].colour", {"tile": [{"name": "a", "side": 1, "colour": 1}]}, "side"),
    ("weights.oak", {"weights": {"oak": "heavy"}}, "a number"),
    ("corner", {"corner": [1.0]}, "2 values"),
    ("digest", {"digest": "x"}, "one of"),
]


@dataclass(frozen=True)
class Round:
    radius: Annotated[float, Part(rule=LENGTH)]


@dataclass(frozen=True)
class Square:
    side: float
    turn_rad: Annotated[float, Part(rule=Angle(-90.0, 90.0))] = 0.0


@dataclass(frozen=True)
class Paint:
    layers: int = setting(1, Number(1.0, 9.0), "Layers of paint")

    def __post_init__(self):
        check_settings(self, "paint")
        if self.layers == 4:
            raise pe.InputError("paint", "layers", "another number than 4", 4)


@dataclass(frozen=True)
class Plate:
    name: Named
    paint: Annotated[Paint, Part(inline=True)] = field(default_factory=Paint)
    holes: Annotated[tuple[Round, ...], Part(key="hole")] = ()


@dataclass(frozen=True)
class Wall:
    plates: Annotated[tuple[Plate, ...], Part(key="plate")] = ()
    tiles: Annotated[Mapping[str, Round | Square], Part(key="tile", by_name=True)] = field(
        default_factory=dict
    )
    weights: Mapping[str, float] = field(default_factory=dict)
    corner: tuple[float, float] | None = None
    digest: Annotated[str, Part(stored=False)] = "kept out"


WALL = Wall(
    plates=(Plate("a", Paint(3), (Round(1.5),)), Plate("b")),
    tiles={"disc": Round(2.0), "turned": Square(1.0, math.radians(30.0)), "flat": Square(2.0)},
    weights={"oak": 0.5},
    corner=(1.0, -2.0),
)


def test_a_tree_is_written_without_defaults_and_comes_back_equal():
    assert write(WALL) == DATA and read(Wall, Node(DATA, "wall")) == WALL
    assert write(Wall()) == {} and read(Wall, Node({}, "wall")) == Wall()
    jsonschema.validate(DATA, schema_of(Wall))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"plate": [{"nam": "a"}]}, schema_of(Wall))


@pytest.mark.parametrize(("path", "data", "expected"), BAD, ids=[row[0] for row in BAD])
def test_what_is_wrong_is_named_by_its_path(path, data, expected):
    with pytest.raises(pe.InputError) as error:
        read(Wall, Node(data, "wall"))
    assert error.value.field == path and error.value.source == "wall"
    assert expected in error.value.expected


def test_settings_are_listed_by_their_key():
    (row,) = declared(Wall)
    assert (row.key, row.cls, row.held_as, row.rows) == ("plate.layers", Paint, "paint", True)

"""`pe set`: a key gets another value, everything else of the file stays."""

import random
import tomllib

import pytest

from pe_tools.cli.set_verb import _changed, _value_at
from pe_tools.cli.verbs import main
from tests.engine.test_docs_examples import STUDY, files_of_a_reader
from tests.engine.test_schemas import STUDIES

COMMENTED = """\
# a study of mine
samples = 1024   # few

[space]
x = [-14, 14] # along
y = [
  -12, # right
  12,
]          # across
z = [0, 2]
interval = 0.5
[vehicle]
mesh = "box.npz"
# the only one
[[sensor]]
name = "roof"      # the first
model = "Velodyne VLP-16 Puck"   # a # in a comment
position = [0.0, 0.0, 1.8]
[[sensor]]
name = "tail"
model = "Velodyne VLP-16 Puck"
position = [-1.0, 0.0, 1.8]
[sensor.bounds]
z = [1.5, 2.0]

[optimize]
stop = { gain = 0.1 } # rule
"""
CHANGES = {
    "samples=2048": [("samples = 1024   # few", "samples = 2048   # few")],
    "sensor.roof.model=Pandar64": [
        (
            'model = "Velodyne VLP-16 Puck"   # a # in a comment',
            'model = "Pandar64"               # a # in a comment',
        )
    ],
    "sensor.tail.bounds.z=[1.6,1.9]": [("z = [1.5, 2.0]", "z = [1.6, 1.9]")],
    "sensor.1.fusion=low": [("position = [-1.0, 0.0, 1.8]\n", '*fusion = "low"\n')],
    "sensor.roof.bounds.x=[-1,1]": [("position = [0.0, 0.0, 1.8]\n", "*bounds.x = [-1, 1]\n")],
    "optimize.stop.seconds=9": [("{ gain = 0.1 } #", "{ gain = 0.1, seconds = 9 } #")],
    "optimize.seed=3": [("# rule\n", "*seed = 3\n")],
    "space.y=[-10,12]": [("y = [\n  -12, # right\n  12,\n]          #", "y = [-10, 12] #")],
    "prior.model=highway": [("# rule\n", '*\n[prior]\nmodel = "highway"\n')],
}


@pytest.fixture
def path(tmp_path):
    files_of_a_reader(tmp_path, "")
    (tmp_path / "study.toml").write_text(COMMENTED, "utf-8")
    return tmp_path / "study.toml"


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_replaces_one_place_and_leaves_the_rest(path, change, capsys):
    assert main(["set", str(path), change]) == 0
    expected = COMMENTED
    for old, new in CHANGES[change]:
        assert old in expected
        expected = expected.replace(old, old + new[1:] if new[0] == "*" else new, 1)
    assert path.read_text("utf-8") == expected
    assert f": {change.partition('=')[0]}: " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("samples", "command line: expected KEY=VALUE, the key as in a study"),
        ("samples=", "command line: samples: expected a value, found"),
        ("sensor.roof=1", "sensor.roof: expected a key of this table, found 1"),
        ("sensor=1", "sensor: expected a key of this table, found 1"),
        (
            "scenario.cut.speed_kmh=9",
            "scenario.cut.speed_kmh: expected cut_in, or one of crossing_child",
        ),
        ("sensor.roof.model=None", "study.toml: sensor.roof.model: expected one of"),
        ("sensor.tail.bounds.q.w=1", "study.toml: sensor.tail.bounds.q: expected one of"),
        ("sensor.1.mount=1", "study.toml: sensor.1.mount: expected"),
        ("space.x.0=15", "study.toml: space.x: expected two finite numbers"),
        ("space.x.high=1", "space.x.high: expected an index from 0 to 1, found 'high'"),
    ],
)
def test_a_change_that_fits_nothing_is_named_as_it_was_typed(path, change, message, capsys):
    scenarios = '\n[[scenario]]\npreset = "crossing_child"\n[[scenario]]\npreset = "cut_in"\n'
    path.write_text(COMMENTED + scenarios, "utf-8")
    assert main(["set", str(path), change]) == 1
    assert message in capsys.readouterr().err
    assert path.read_text("utf-8") == COMMENTED + scenarios


def leaves(data, path=()):
    if isinstance(data, dict) and data:
        for key, value in data.items():
            yield from leaves(value, (*path, key))
    elif isinstance(data, list) and data and all(isinstance(each, dict) for each in data):
        for number, value in enumerate(data):
            yield from leaves(value, (*path, number))
    else:
        yield path, data


def test_the_file_keeps_its_permissions_its_link_and_its_line_ends(path, capsys):
    """0600 became 0644, a link a file of its own, and CRLF became LF."""
    data = path.read_bytes().replace(b"\n", b"\r\n")
    path.write_bytes(data)
    path.chmod(0o600)
    link = path.with_name("link.toml")
    link.symlink_to(path.name)
    assert main(["set", str(link), "samples=2048"]) == 0
    assert link.is_symlink() and path.stat().st_mode & 0o777 == 0o600
    assert path.read_bytes() == data.replace(b"samples = 1024 ", b"samples = 2048 ")


@pytest.mark.parametrize("path", [*STUDIES[::5], None], ids=lambda p: p and p.parent.name)
def test_each_key_of_an_example_can_be_changed_alone(path):
    """A text with one key changed is the data with that key changed, and no comment is lost."""
    text = STUDY if path is None else path.read_text("utf-8")
    comments = text.count("#")
    found = list(leaves(tomllib.loads(text)))
    for place, value in random.Random(1).sample(found, min(len(found), 25)):
        wanted = tomllib.loads(text)
        _value_at(wanted, place[:-1])[place[-1]] = "new # text" if value != "new" else 1
        changed = _changed(text, place, wanted)
        assert tomllib.loads(changed) == wanted, place
        assert changed.count("#") == comments + 1

"""Results are written over no file that we did not write, and the set of a run is one."""

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools import jobs
from pe_tools.cli.verbs import main
from pe_tools.jobs import FileSet
from tests.engine import shapes

LISTING = ".perception-entropy.json"
NAMES = ("study.toml", "vehicle.npz", "boxes.csv", "history.csv", "result.json")
SHORT = ("--method", "random", "--set", "optimize.candidates=2", "--set", "optimize.samples=2048")


def a_study(boxes=True, x=-0.43):
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(16, 180), (x, 0.0, 1.8))])
    prior = pe.Prior.from_boxes(shapes_boxes()) if boxes else pe.Prior.road()
    return shapes.car_study(rig, prior=prior)


def shapes_boxes():
    return pe.Boxes.of([("car", 20.0, 3.0, 0.8, 4.0, 2.0, 1.6, 0.5)])


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "input" / "car.toml"
    path.parent.mkdir()
    pt.export_study(a_study(), path)
    return path


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


@pytest.fixture
def no_work(monkeypatch):
    """Fail when anything is scored."""

    def never(*_args, **_options):
        raise AssertionError("work was begun")

    monkeypatch.setattr(pe.Study, "evaluator", never)


def optimize(study, out, *options):
    return main(["optimize", "--no-review", str(study), "-o", str(out), *SHORT, *options])


def contents(folder):
    return {p.name: p.read_bytes() for p in folder.iterdir()}


def one_line(capsys):
    (line,) = capsys.readouterr().err.splitlines()
    return line


@pytest.mark.parametrize("name", NAMES)
def test_a_users_own_file_is_refused_before_the_work(study, out, name, capsys, no_work):
    (out / name).write_text("mine")
    assert optimize(study, out) == 1
    line = one_line(capsys)
    assert line.startswith(f"pe: {out / name}: output: ") and "choose another folder" in line
    assert contents(out) == {name: b"mine"}


def test_the_folder_of_the_study_is_refused(tmp_path, capsys, monkeypatch, no_work):
    pt.export_study(a_study(), tmp_path / "study.toml")
    before = contents(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert optimize("study.toml", ".") == 1
    assert one_line(capsys).startswith("pe: study.toml: file: expected another file than the input")
    assert contents(tmp_path) == before


def test_an_export_replaces_what_was_chosen_and_not_its_neighbours(tmp_path):
    path = tmp_path / "car.toml"
    mesh = tmp_path / "car.npz"
    path.write_text("mine")
    with pytest.raises(pe.InputError, match=r"car\.toml: output: expected no file"):
        pt.export_study(a_study(), path)
    mesh.write_text("mine too")
    before = contents(tmp_path)
    with pytest.raises(pe.InputError, match=r"car\.npz: output: expected no file"):
        pt.export_study(a_study(), path, replace_study=True)
    assert contents(tmp_path) == before
    mesh.unlink()
    pt.export_study(a_study(), path, replace_study=True)
    assert pe.load_study(path).rig["roof"].pose.position[0] == -0.43
    pt.export_study(a_study(x=0.1), path)  # all three are ours now
    assert pe.load_study(path).rig["roof"].pose.position[0] == 0.1


@pytest.mark.parametrize("stops_at", [0, 1, 2])
def test_killed_between_two_files_all_of_them_are_still_ours(tmp_path, stops_at, monkeypatch):
    """The list is written first: what was not replaced yet is known by its old digest."""
    with FileSet(tmp_path) as files:
        files.add("a", b"1")
        files.add("b", b"1")
    replace = jobs.folder.os.replace
    done = []

    def replace_some(source, target):
        if not str(target).endswith(LISTING):
            if len(done) == stops_at:
                raise KeyboardInterrupt
            done.append(target)
        replace(source, target)

    monkeypatch.setattr("os.replace", replace_some)
    try:
        with FileSet(tmp_path) as files:
            files.add("a", b"2")
            files.add("b", b"2")
    except KeyboardInterrupt:
        assert stops_at < 2
    monkeypatch.setattr("os.replace", replace)
    with FileSet(tmp_path) as files:
        files.add("a", b"3")
        files.add("b", b"3")
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes() == b"3"


def test_what_another_run_left_is_taken_away(study, out, capsys):
    assert optimize(study, out) == 0
    (out / "notes.txt").write_text("mine")
    assert main(["score", str(study), "-o", str(out)]) == 0
    assert set(contents(out)) == {*NAMES, LISTING, "notes.txt"} - {"history.csv"}
    assert "not of this run" not in capsys.readouterr().err
    assert optimize(study, out) == 0
    assert "history.csv" in contents(out)

"""Reading and writing whole files, and how much memory there is: the rules that readers share."""

import csv
import errno
import os
import stat
import sys

import pytest

from pe_core.base import files
from pe_core.base.errors import InputError
from pe_core.base.files import (
    csv_text,
    put_in_place,
    read_bytes,
    require_new,
    unmarked,
    write_all_bytes,
    write_bytes,
)
from pe_core.base.input_files import not_noting_inputs, noting_inputs

resource = pytest.importorskip("resource")
FAULTS = ("ENOSPC", "EDQUOT", "EIO")
FORMULAS = ('=HYPERLINK("http://a.b","c")', "+cmd", "-1+A1", "@SUM(A1)", "'=1", "\t=1", "＝1")
PLAIN = ("front", "-1.5", "+1e-3", "-0.33 0.11 -2", "a=b", "'twas", "", "3,5", 'say "so"')


def test_a_file_may_be_as_large_as_its_limit_and_no_larger(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"12345")
    assert read_bytes(path, 5) == b"12345"
    with pytest.raises(InputError, match=r"a: size: expected.*4"):
        read_bytes(path, 4)


@pytest.mark.parametrize(("grown", "whole"), [(3, True), (4, True), (5, False), (9_000_000, False)])
def test_a_file_that_grows_while_it_is_read_is_bounded_too(tmp_path, monkeypatch, grown, whole):
    """The size is asked before the first byte is read; then more comes."""
    path = tmp_path / "log"
    read = os.read
    path.write_bytes(b"12345678")

    def read_and_grow(handle, count):
        data = read(handle, count)
        if path.stat().st_size == 8:
            with path.open("ab") as file:
                file.write(b"x" * grown)
        assert count <= files.CHUNK
        return data

    monkeypatch.setattr(os, "read", read_and_grow)
    if whole:
        assert read_bytes(path, 12) == b"12345678" + b"x" * grown
    else:
        with pytest.raises(InputError, match=r"log: size: expected.*12"):
            read_bytes(path, 12)


@pytest.mark.skipif(sys.platform == "win32", reason="no such thing there")
def test_a_file_that_turns_into_a_pipe_before_it_is_opened(tmp_path, monkeypatch):
    """The look from outside said that it is a file; opening must not block all the same."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "file").touch()
    seen = os.stat(tmp_path / "file")
    monkeypatch.setattr(os, "stat", lambda *_, **__: seen)
    with pytest.raises(InputError, match=r"pipe: file: .* a pipe"):
        read_bytes(tmp_path / "pipe")


@pytest.mark.skipif(sys.platform == "win32", reason="no such thing there")
@pytest.mark.parametrize("kind", ["a folder", "a pipe", "a device"])
def test_only_files_are_written_over(tmp_path, kind):
    """Whatever stands in a file's place stays, and nothing is left beside it."""
    path = tmp_path / "out"
    match kind:
        case "a folder":
            path.mkdir()
        case "a pipe":
            os.mkfifo(path)
        case "a device":
            path.symlink_to("/dev/null")
    before = os.lstat(path).st_mode
    with pytest.raises(
        InputError, match=f"out: file: expected a path that can be written, found {kind}"
    ):
        write_bytes(path, b"data")
    assert os.lstat(path).st_mode == before
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_several_files_are_written_together_or_not_at_all(tmp_path):
    (tmp_path / "first").write_bytes(b"old")
    (tmp_path / "second").mkdir()
    new = {tmp_path / name: b"new" for name in ("first", "second")}
    with pytest.raises(InputError, match="second: file: expected"):
        write_all_bytes(new)
    assert (tmp_path / "first").read_bytes() == b"old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["first", "second"]
    (tmp_path / "second").rmdir()
    write_all_bytes(new)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == new


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize(
    ("call", "first"),
    [("write", 1), ("write", 2), ("fsync", 1), ("fsync", 2), ("replace", 1), ("replace", 2)],
)
def test_a_disk_that_fails_leaves_all_old_files(tmp_path, failing_call, call, first, fault):
    old = {tmp_path / name: name.encode() for name in ("first", "second")}
    write_all_bytes(old)
    count = failing_call(call, getattr(errno, fault), first, once=call == "replace")
    reason = os.strerror(getattr(errno, fault)).lower()
    with pytest.raises(InputError, match=f"file: expected a path that can be written.*{reason}"):
        write_all_bytes(dict.fromkeys(old, b"new") | {tmp_path / "third": b"new"})
    assert count.fired >= 1
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == old


def test_a_file_is_on_the_disk_before_its_name_counts_and_its_folder_after(tmp_path, monkeypatch):
    """Else a power failure leaves an empty file, or the old name."""
    done = []
    real = {name: getattr(os, name) for name in ("write", "fsync", "replace")}

    def noted(name):
        def call(first, *others):
            at = os.readlink(f"/proc/self/fd/{first}") if isinstance(first, int) else first
            done.append((name, "folder" if os.path.isdir(at) else "file"))
            return real[name](first, *others)

        return call

    for name in real:
        monkeypatch.setattr(os, name, noted(name))
    write_bytes(tmp_path / "study.toml", b"data")
    in_order = [("write", "file"), ("fsync", "file"), ("replace", "file"), ("fsync", "folder")]
    assert done == in_order


def test_the_rule_for_outputs(tmp_path):
    """A name that is free, or one that the user gives away; a link counts, an input never goes."""
    path, link, loop = (tmp_path / name for name in ("mine", "link", "loop"))
    require_new(path, replace=False)
    path.write_bytes(b"mine")
    link.symlink_to("nowhere")
    loop.symlink_to("loop")
    for each, found in ((path, "an existing file"), (link, "a link"), (loop, "a link")):
        with pytest.raises(InputError, match=f"a new file, or --replace, found {found}"):
            require_new(each, replace=False)
        require_new(each, replace=True)
    (tmp_path / "also").symlink_to("mine")
    with pytest.raises(InputError, match="another file than the input"), noting_inputs():
        read_bytes(path)
        require_new(tmp_path / "also", replace=True)


def test_no_writer_replaces_what_a_command_has_read(tmp_path):
    """Under any of its names; files that are read to be changed are none of its inputs."""
    path, other, link = (tmp_path / name for name in ("mine", "other", "link"))
    path.write_bytes(b"mine")
    link.hardlink_to(path)
    with noting_inputs():
        read_bytes(path)
        for name in (path, link):
            with pytest.raises(InputError, match="another file than the input"):
                write_all_bytes({other: b"new", name: b"new"})
            with pytest.raises(InputError, match="another file than the input"):
                put_in_place({other: name})
        assert not other.exists() and path.read_bytes() == b"mine"
        write_bytes(other, b"made")
        with not_noting_inputs():
            read_bytes(other)
        write_bytes(other, b"changed")
    write_bytes(path, b"changed")
    assert (path.read_bytes(), other.read_bytes()) == (b"changed", b"changed")


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o755])
def test_a_file_that_is_replaced_keeps_its_permissions_and_a_link_to_it_stays(tmp_path, mode):
    """By each of the two ways in which files are written: a link is followed, as by an editor."""
    path, link, second = (tmp_path / name for name in ("mine", "link", "second"))
    for each in (path, second):
        each.write_bytes(b"old")
        each.chmod(mode)
    link.symlink_to("mine")
    write_all_bytes({link: b"new", tmp_path / "fresh": b"new"})
    (tmp_path / "made").write_bytes(b"new")
    put_in_place({tmp_path / "made": second})
    assert link.is_symlink() and path.read_bytes() == second.read_bytes() == b"new"
    assert [stat.S_IMODE(each.stat().st_mode) for each in (path, second)] == [mode, mode]
    (tmp_path / "other").write_bytes(b"")
    fresh = [(tmp_path / name).stat().st_mode for name in ("fresh", "other")]
    assert fresh[0] == fresh[1], "a new file has the permissions of the user's other new files"


@pytest.mark.parametrize("text", [*FORMULAS, *PLAIN])
def test_no_cell_of_a_table_is_a_formula_and_ours_are_read_back(text):
    ((cell, number, empty),) = csv.reader([csv_text([[text, -1.5, None]])])
    assert (cell == text) == (text in PLAIN) and (number, empty) == ("-1.5", "")
    assert cell == text or cell[0] == "'"
    assert unmarked(cell) == text

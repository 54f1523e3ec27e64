"""A package whose names are loaded when they are asked for leaves Python's import as it was."""

import builtins
import sys
import threading
from types import ModuleType

import pytest

from pe_core.lazy_faces import lazy_face
from tests.limits import HANG_S


@pytest.fixture
def faces(monkeypatch):
    names = ("face_of_one_thread", "face_of_another")
    for name in names:
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    return names


def test_two_threads_that_load_faces_put_back_the_import_that_was(faces):
    first, second = faces
    before = builtins.__import__
    is_inside = threading.Event()
    has_left = threading.Event()

    def load_second():
        is_inside.wait(HANG_S)
        with lazy_face(second):
            has_left.wait(HANG_S)

    other = threading.Thread(target=load_second)
    other.start()
    with lazy_face(first):
        is_inside.set()
        other.join(0.2)  # it has to wait for this one to leave
    has_left.set()
    other.join(HANG_S)
    assert not other.is_alive() and builtins.__import__ is before


def test_what_fails_within_leaves_the_import_that_was(faces):
    before = builtins.__import__
    with pytest.raises(LookupError), lazy_face(faces[0]):
        raise LookupError
    assert builtins.__import__ is before

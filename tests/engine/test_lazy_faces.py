"""A package whose names are loaded when they are asked for leaves Python's import as it was."""

import builtins
import subprocess
import sys
import threading
from types import ModuleType

import pytest

from pe_core.lazy_faces import lazy_face
from tests.limits import HANG_S

ALL_HOOKS = """
import importlib, pkgutil
from pe_core.base.codec import HOOKS
from pe_core.study.study_file import load_study
known = set(HOOKS)
import pe_core
for module in pkgutil.walk_packages(pe_core.__path__, "pe_core."):
    importlib.import_module(module.name)
print(*sorted(cls.__name__ for cls in set(HOOKS) - known))
"""


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


def test_who_reads_studies_has_loaded_all_that_reads_a_part_of_them():
    """What reads a class is known where its module was loaded, and faces load modules late."""
    ran = subprocess.run(
        [sys.executable, "-c", ALL_HOOKS], capture_output=True, text=True, check=True
    )
    assert ran.stdout.split() == []

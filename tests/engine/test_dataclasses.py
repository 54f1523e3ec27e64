"""Dataclasses of the engine: what others hold can't be changed once it is made."""

import dataclasses
import importlib
import inspect
import pkgutil

import pytest

import pe_core as pe

MODULES = [
    importlib.import_module(found.name)
    for found in pkgutil.walk_packages(pe.__path__, "pe_core.")
    if not found.name.endswith("__main__")
]
CLASSES = {
    f"{module.__name__}.{name}": cls
    for module in MODULES
    for name, cls in inspect.getmembers(module, inspect.isclass)
    if dataclasses.is_dataclass(cls) and cls.__module__ == module.__name__ and name[0] != "_"
}
BUILT_UP = {"pe_tools.formats.boxes.labels.Labels", "pe_tools.cli.interrupts.Received"}
"""Filled while a file is read, or signals come; so are some that are private."""


def test_there_are_dataclasses_in_most_rooms():
    rooms = {name.split(".")[1] for name in CLASSES}
    assert (
        len(CLASSES) > 40 and {"scene", "metric", "prior", "sensors", "scoring", "study"} <= rooms
    )


@pytest.mark.parametrize("name", sorted(CLASSES.keys() - BUILT_UP))
def test_dataclasses_are_frozen(name):
    assert CLASSES[name].__dataclass_params__.frozen

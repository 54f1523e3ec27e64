"""Dataclasses of the engine and its tools: what others hold can't be changed once it is made."""

import dataclasses
import functools
import importlib
import inspect
import pkgutil

import pe_core
import pe_tools

BUILT_UP = {
    "pe_tools.formats.boxes.labels.Labels",
    "pe_tools.cli.interrupts.Received",
    "pe_tools.page.pictures.svg.Canvas",
}
"""Filled while a file is read, signals come or a picture is drawn; so are some that are private."""


@functools.cache
def classes():
    """Public dataclasses by module and name."""
    modules = [
        importlib.import_module(found.name)
        for package in (pe_core, pe_tools)
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
        if not found.name.endswith("__main__")
    ]
    return {
        f"{module.__name__}.{name}": cls
        for module in modules
        for name, cls in inspect.getmembers(module, inspect.isclass)
        if dataclasses.is_dataclass(cls) and cls.__module__ == module.__name__ and name[0] != "_"
    }


def test_there_are_dataclasses_in_most_rooms():
    rooms = {name.split(".")[1] for name in classes()}
    assert (
        len(classes()) > 40 and {"scene", "metric", "prior", "sensors", "scoring", "study"} <= rooms
    )


def test_dataclasses_are_frozen():
    thawed = {name for name, cls in classes().items() if not cls.__dataclass_params__.frozen}
    assert thawed == BUILT_UP

"""Threads and locks, imported where the first of them is made."""

from types import ModuleType


def threads() -> ModuleType:
    """Return the module `threads`: in a window Blender computes nothing, and never has it."""
    from . import threads as found

    return found

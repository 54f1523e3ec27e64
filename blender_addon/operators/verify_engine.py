"""Verify the engine, from the preferences."""

import bpy

from ..preferences import verification
from .declared import operator


@operator(
    "Verify the Engine",
    unless=lambda _context: "It is being verified" if verification.is_running() else None,
    options=frozenset(),
)
def verify_engine(_context: bpy.types.Context) -> str | None:
    """Hold the engine, as it is installed, to its golden cases: some 10 s"""
    verification.begin()
    found = verification.lines()
    return found[0] if found else None

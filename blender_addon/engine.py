"""The one door to the engine and to the tools around it.

Everything else in the add-on takes them from here. A room is imported when it is first asked for,
as the engine's process needs few of them. In Blender's extension both packages lie inside the
add-on: the build turns these imports into relative ones.
"""

from importlib import import_module
from typing import TYPE_CHECKING

import pe_core as pe
import pe_tools as tools
from pe_core.base import Flags, Floats, Ints, Singles

if TYPE_CHECKING:
    from pe_core import base as text
    from pe_core import catalog, motion, scoring, search
    from pe_core import scene as geometry
    from pe_core import sensors as kinds
    from pe_core import study as studies
    from pe_core.scoring import requirements, sight
    from pe_tools import (
        advice,
        engine_process,
        exchange,
        formats,
        graphics,
        jobs,
        known_defects,
        outputs,
        page,
        verify,
        wording,
    )
    from pe_tools import cli as app

ROOMS = {
    "advice": (tools, "advice"),
    "app": (tools, "cli"),
    "catalog": (pe, "catalog"),
    "engine_process": (tools, "engine_process"),
    "exchange": (tools, "exchange"),
    "formats": (tools, "formats"),
    "geometry": (pe, "scene"),
    "graphics": (tools, "graphics"),
    "jobs": (tools, "jobs"),
    "known_defects": (tools, "known_defects"),
    "motion": (pe, "motion"),
    "kinds": (pe, "sensors"),
    "outputs": (tools, "outputs"),
    "page": (tools, "page"),
    "requirements": (pe, "scoring.requirements"),
    "scoring": (pe, "scoring"),
    "search": (pe, "search"),
    "sight": (pe, "scoring.sight"),
    "studies": (pe, "study"),
    "text": (pe, "base"),
    "verify": (tools, "verify"),
    "wording": (tools, "wording"),
}
"""Where the rooms are, by the names that they have in the add-on."""


def __getattr__(name: str) -> object:
    if name not in ROOMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    package, room = ROOMS[name]
    return import_module(f"{package.__name__}.{room}")

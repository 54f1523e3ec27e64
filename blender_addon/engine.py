"""The one door to the engine and to the tools around it.

Everything else in the add-on takes them from here. In Blender's extension both packages lie inside
the add-on: the build turns these imports into relative ones.
"""

import pe_core as pe
from pe_core import base as text
from pe_core import catalog, scoring, search
from pe_core import scene as geometry
from pe_core import sensors as kinds
from pe_core import study as studies
from pe_core.base import Flags, Floats, Ints, Singles
from pe_core.scoring import requirements, sight
from pe_tools import advice, exchange, graphics, jobs, outputs, page, wording
from pe_tools import cli as app

__all__ = [
    "Flags",
    "Floats",
    "Ints",
    "Singles",
    "advice",
    "app",
    "catalog",
    "exchange",
    "geometry",
    "graphics",
    "jobs",
    "kinds",
    "outputs",
    "page",
    "pe",
    "requirements",
    "scoring",
    "search",
    "sight",
    "studies",
    "text",
    "wording",
]

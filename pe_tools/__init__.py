"""What stands round the engine and needs no Blender: files, exchange, pictures, pages, commands.
The names in `pe_tools.public` are here too, loaded when one is first asked for."""

from typing import TYPE_CHECKING

from pe_core import _lazy_names

if TYPE_CHECKING:  # a checker knows these names, and no others
    from .public import *  # noqa: F403
else:
    __getattr__, __dir__ = _lazy_names(__name__)

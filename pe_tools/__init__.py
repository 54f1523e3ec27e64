"""What stands round the engine and needs no Blender: files, exchange, pictures, pages, commands.
The names in `pe_tools.public` are here too, loaded when one is first asked for."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a checker knows these names, and no others
    from .public import *  # noqa: F403
else:
    from pe_core.lazy_faces import public_names

    __getattr__, __dir__ = public_names(__name__)

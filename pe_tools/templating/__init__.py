"""Templates in the part of Jinja's language that ours use, and text that is HTML already."""

from .markup import Markup, escape
from .template import Templates

__all__ = ["Markup", "Templates", "escape"]

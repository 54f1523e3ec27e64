"""The pictures of the documentation, made in a real window: `make screenshots`."""

from .assets import ASSETS
from .film import FILM
from .guide import GUIDE
from .mounts import MOUNTS
from .reel import Reel
from .region import FREE_REGION
from .requirements import REQUIREMENTS
from .surround import SURROUND
from .tour import TOUR

REELS = {
    "guide": GUIDE,
    "assets": ASSETS,
    "film": FILM,
    "mounts": MOUNTS,
    "region": FREE_REGION,
    "requirements": REQUIREMENTS,
    "surround": SURROUND,
    "tour": TOUR,
}
"""By the name that `tools/screenshots.py` takes."""

__all__ = ["REELS", "Reel"]

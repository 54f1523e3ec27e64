"""The one door to the engine and to the page of a review: the copies packed into the extension,
else the checkout's.

Everything else in the add-on takes them from here, so that there is never a second copy of
it in a running Blender.
"""

from importlib import import_module
from importlib.util import find_spec

_PACKED = f"{__package__}.pe_core"
_NAME = _PACKED if find_spec(_PACKED) else "pe_core"

pe = import_module(_NAME)
advice = import_module(f"{_NAME}.advice")
app = import_module(f"{_NAME}.app")
catalog = import_module(f"{_NAME}.catalog")
exchange = import_module(f"{_NAME}.exchange")
graphics = import_module(f"{_NAME}.graphics")
geometry = import_module(f"{_NAME}.scene")
kinds = import_module(f"{_NAME}.kinds")
outputs = import_module(f"{_NAME}.outputs")
search = import_module(f"{_NAME}.search")
scoring = import_module(f"{_NAME}.scoring")
sight = import_module(f"{_NAME}.sight")
studies = import_module(f"{_NAME}.study")
text = import_module(f"{_NAME}.text")

_PACKED_PAGE = f"{__package__}.pe_review"
page = import_module(_PACKED_PAGE if find_spec(_PACKED_PAGE) else "pe_review")

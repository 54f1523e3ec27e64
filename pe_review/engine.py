"""The one door to the engine: the copy packed beside this package, else the checkout's own."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pe_core as pe
    from pe_core import (
        advice,
        app,
        catalog,
        graphics,
        kinds,
        metric,
        scene,
        scoring,
        search,
        sight,
        text,
    )
    from pe_core import study as studies
else:
    _HOME = __package__.rpartition(".")[0]
    _NAME = f"{_HOME}.pe_core" if _HOME else "pe_core"

    pe = import_module(_NAME)
    advice = import_module(f"{_NAME}.advice")
    app = import_module(f"{_NAME}.app")
    catalog = import_module(f"{_NAME}.catalog")
    graphics = import_module(f"{_NAME}.graphics")
    kinds = import_module(f"{_NAME}.kinds")
    metric = import_module(f"{_NAME}.metric")
    scene = import_module(f"{_NAME}.scene")
    scoring = import_module(f"{_NAME}.scoring")
    search = import_module(f"{_NAME}.search")
    sight = import_module(f"{_NAME}.sight")
    studies = import_module(f"{_NAME}.study")
    text = import_module(f"{_NAME}.text")

__all__ = [
    "advice",
    "app",
    "catalog",
    "graphics",
    "kinds",
    "metric",
    "pe",
    "scene",
    "scoring",
    "search",
    "sight",
    "studies",
    "text",
]

"""Plugins: tools beside the engine and optional packages, found at run time.

A plugin has a name of two parts, its sort and its own name: ``mesh.dae`` reads Collada. `SHIPPED`
lists those of this project; other packages add plugins by entry points of the group `GROUP`. A
plugin is foreign code: a library may be missing, it may fail, or return a wrong type. Each of these
becomes an `InputError` that names the plugin and its package.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from .errors import InputError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "perception_entropy.plugins"
HOME = __name__.partition("pe_core.")[0]
"""The package around `pe_core` and `pe_tools`: empty but in Blender's extension."""
SHIPPED = {
    "catalog.housing": "pe_core.catalog:housing",
    "catalog.data_sheet": "pe_core.catalog:data_sheet",
    "reader.angles": "pe_tools.formats.angles:read_angles",
    "reader.mesh": "pe_tools.formats:read_mesh",
    "reader.boxes": "pe_tools.formats:read_boxes",
    "mesh.dae": "pe_tools.formats.meshes.collada:read_dae",
    "mesh.usd": "pe_tools.formats.meshes.usd:read_usd",
    "mesh.usda": "pe_tools.formats.meshes.usd:read_usd",
    "mesh.usdc": "pe_tools.formats.meshes.usd:read_usd",
    "mesh.usdz": "pe_tools.formats.meshes.usd:read_usd",
    "library.usd_text": "pe_tools.exchange.usd_library:text_of_binary",
    "library.usd_packed": "pe_tools.exchange.usd_library:packed",
    "library.picture": "pe_tools.page.pictures.vehicle_picture:picture_output",
    "page.review": "pe_tools.page:review_studies",
    "page.search": "pe_tools.page:write_search_page",
    "page.front": "pe_tools.page:write_front_page",
    "page.verification": "pe_tools.page:verification_page",
    "verify.engine": "pe_tools.verify.kit:verify_engine",
}
"""Plugins of this distribution: module and attribute, by the plugin's name."""
EXTRAS = {
    "mesh": "meshes",
    "library.usd_text": "meshes",
    "library.usd_packed": "meshes",
    "pyarrow.feather": "argoverse",
    "matplotlib": "notebook",
    "pandas": "notebook",
    "pyarrow": "argoverse",
    "tqdm.auto": "notebook",
    "distributed": "cluster",
}
"""The extra that installs what a plugin, or a sort of plugins, or a verb needs."""


def shipped(name: str) -> Any:
    """Return what a name of `SHIPPED` leads to. The engine asks here for readers of files, which it
    does not import, and searches for what the catalogue knows of a model."""
    module, _, attribute = SHIPPED[name].partition(":")
    return getattr(import_module(HOME + module), attribute)


def find_plugin(sort: str, name: str) -> EntryPoint | None:
    """Return the plugin of a sort and a name; one that is shipped comes first."""
    full = f"{sort}.{name}"
    if full in SHIPPED:
        return _shipped_point(full)
    from importlib.metadata import entry_points

    return next(iter(entry_points(group=GROUP, name=full)), None)


def find_plugins(sort: str) -> list[EntryPoint]:
    """Return all plugins of a sort: those shipped that are present, then those of other packages.
    Blender's extension leaves some of those shipped out."""
    from importlib.metadata import entry_points

    own = [_shipped_point(name) for name in SHIPPED if name.startswith(f"{sort}.")]
    others = [point for point in entry_points(group=GROUP) if point.name.startswith(f"{sort}.")]
    return [*(point for point in own if _is_present(point)), *others]


def install_hint(sort: str, name: str) -> str:
    """Return the command that installs what a plugin needs."""
    extra = EXTRAS.get(f"{sort}.{name}", EXTRAS.get(sort, ""))
    return extra_text(extra) if extra else "a package that brings it"


def extra_text(extra: str) -> str:
    """Return the command that installs an extra; it can be typed in any shell."""
    return f'pip install "perception-entropy[{extra}]"'


def optional_package(package: str) -> Any | None:
    """Return a package of `EXTRAS`; None where it is not installed."""
    assert package in EXTRAS
    try:
        return import_module(package)
    except ImportError:
        return None


def required_package(package: str) -> Any:
    """Return a package of `EXTRAS`; `InputError` with the command that installs it."""
    found = optional_package(package)
    if found is None:
        expected = f"{package}: {extra_text(EXTRAS[package])}"
        raise InputError("packages", package, expected, "not installed")
    return found


def plugin_name(point: EntryPoint) -> str:
    """Return the name of a plugin and its package, for messages."""
    package = point.dist.name if point.dist is not None else point.module
    return f"plugin {point.name.partition('.')[2]!r} of {package}"


def load_plugin(point: EntryPoint) -> Any:
    """Return the object that an entry point names. `ImportError` when a library is missing: the
    caller knows which extra installs it. `InputError` when the plugin fails while it is loaded."""
    return _guarded(point, "to load", point.load, ImportError)


def call_plugin(point: EntryPoint, function: Any, *arguments: Any) -> Any:
    """Call a plugin's function. `InputError` when it is not a function, or raises any exception;
    its own `InputError` is kept."""
    if not callable(function):
        raise InputError(plugin_name(point), "entry point", "a function", type(function).__name__)
    return _guarded(point, "to complete", lambda: function(*arguments), InputError)


def required_plugin(sort: str, name: str, source: str, field: str, expected: str) -> Any:
    """Return a plugin, and what it leads to. `InputError` when there is none, or a library is
    missing: `expected` says what to install."""
    point = find_plugin(sort, name)
    if point is None:
        raise InputError(source, field, expected, "none installed")
    try:
        return point, load_plugin(point)
    except ImportError as error:
        raise InputError(source, field, expected, " ".join(str(error).split())) from error


def _shipped_point(name: str) -> EntryPoint:
    from importlib.metadata import EntryPoint

    return EntryPoint(name, HOME + SHIPPED[name], GROUP)


def _is_present(point: EntryPoint) -> bool:
    try:
        return find_spec(point.module) is not None
    except ModuleNotFoundError:
        return False


def _guarded(
    point: EntryPoint, expected: str, work: Callable[[], Any], passed: type[Exception]
) -> Any:
    try:
        return work()
    except passed:
        raise
    except (Exception, SystemExit) as error:  # foreign code may raise anything
        found = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(plugin_name(point), "plugin", expected, found) from error

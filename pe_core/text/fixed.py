"""A mapping that nobody can change, and that may be sent to another process."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn


class FixedDict(dict[str, Any]):
    """A copy of a mapping and of those in it, for good. (`MappingProxyType` cannot be pickled.)"""

    def __init__(self, values: Mapping[str, Any] = {}) -> None:
        super().__init__({key: fixed(value) for key, value in values.items()})

    def _refused(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("this mapping is fixed; make another one")

    __setitem__ = __delitem__ = __ior__ = _refused  # type: ignore[assignment]
    clear = pop = popitem = setdefault = update = _refused  # type: ignore[assignment]

    def __reduce__(self) -> tuple[object, ...]:
        return FixedDict, (dict(self),)


def fixed(value: Any) -> Any:
    """Return plain data as it is, with mappings and lists made such that nobody can change them."""
    if isinstance(value, Mapping):
        return FixedDict(value)
    return tuple(map(fixed, value)) if isinstance(value, (list, tuple)) else value

"""What candidates have in common is sent to a worker once, and kept there by a key of its content.

An objective, the vehicle and sensors' models are large, candidates are small. So whatever is sent
names them by a key; a worker that does not know a key asks for it.
"""

from __future__ import annotations

import hashlib
import io
import pickle
import threading
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from typing import Any
from weakref import WeakKeyDictionary

from ..scene.sensors import SensorModel
from ..scene.vehicle import Vehicle

KEPT = 32
"""So many parcels a worker keeps: the last that were asked for."""

_PACKED: WeakKeyDictionary[Any, Parcel] = WeakKeyDictionary()
"""What was packed before, as long as somebody holds it."""
_HERE = threading.local()
"""What this worker keeps: a thread of its own shares nothing, so that none waits for another."""


class NotHere(LookupError):
    """Parcels that this worker does not know; `keys` says which."""

    def __init__(self, keys: Iterable[str]) -> None:
        super().__init__(*keys)
        self.keys = tuple(keys)


class Parcel:
    """Something made ready to be sent.

    Parameters
    ----------
    content : object
        It can be pickled.

    Attributes
    ----------
    data : bytes
    key : str
        A hash of it.
    inner : dict of str to Parcel
        Those that it names, theirs included.
    """

    def __init__(self, content: object) -> None:
        file = io.BytesIO()
        packer = _Packer(file, content)
        packer.dump(content)
        self.data, self.inner = file.getvalue(), packer.inner
        self.key = hashlib.sha256(self.data).hexdigest()

    @property
    def all(self) -> dict[str, Parcel]:
        """This one and those that it names, by key; what is named comes first."""
        return {**self.inner, self.key: self}


class _Packer(pickle.Pickler):
    """Pickles, but what is large gets a parcel of its own."""

    def __init__(self, file: io.BytesIO, content: object) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._content = content
        self.inner: dict[str, Parcel] = {}

    def persistent_id(self, thing: Any) -> str | None:
        if thing is self._content or not isinstance(thing, (Vehicle, SensorModel)):
            return None
        parcel = packed(thing)
        self.inner.update(parcel.all)
        return parcel.key


class _Unpacker(pickle.Unpickler):
    """Unpickles; what has a parcel of its own is here already."""

    def persistent_load(self, key: Any) -> Any:
        return _kept()[key]


def packed(thing: Any) -> Parcel:
    """Return something as a parcel; it is packed once, as it must not change after that."""
    try:
        known = _PACKED.get(thing)
    except TypeError:  # it has no hash, or cannot be referred to weakly
        return Parcel(thing)
    if known is None:
        known = _PACKED[thing] = Parcel(thing)
    return known


def unpacked(key: str, data: Mapping[str, bytes], needed: Iterable[str]) -> Any:
    """Return what a key stands for, in a worker.

    Parameters
    ----------
    key : str
    data : mapping of str to bytes
        Parcels that came along; what one of them names comes before it.
    needed : iterable of str
        Keys of all that have to be here.

    Raises
    ------
    NotHere
        When some are not.
    """
    kept = _kept()
    for name, each in data.items():
        if name not in kept:
            kept[name] = contents(each)
    if missing := [name for name in needed if name not in kept]:
        raise NotHere(missing)
    for name in needed:
        kept.move_to_end(name)
    found = kept[key]
    while len(kept) > KEPT:
        kept.popitem(last=False)
    return found


def contents(data: bytes) -> Any:
    """Unpack data whose parcels are all here."""
    return _Unpacker(io.BytesIO(data)).load()


def _kept() -> OrderedDict[str, Any]:
    if not hasattr(_HERE, "kept"):
        _HERE.kept = OrderedDict()
    kept: OrderedDict[str, Any] = _HERE.kept
    return kept

"""A note beside scores of rigs that differ in their sensors, and not in their placement alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pe_core.scene.rig import SensorModel
from pe_core.study.catalog_lookup import same_model

OTHER_HARDWARE = (
    "The rigs differ in models or numbers of sensors. On simulated rigs of LiDARs entropy was not "
    "shown to rank better than the number of beams, and it can prefer a rig with a blind sector; "
    "cameras and radars were not tested. Look at blind ground, and at the expected AP in traffic, "
    "beside it (docs/validity/own)."
)


def hardware_note(rigs: Iterable[Sequence[SensorModel]]) -> str:
    """Return `OTHER_HARDWARE` where rigs have other models or numbers of sensors; else nothing.

    Parameters
    ----------
    rigs : iterable of sequence of SensorModel
        The models of each rig's sensors, in any order.
    """
    first, *others = [list(models) for models in rigs] or [[]]
    return "" if all(_is_same(first, models) for models in others) else OTHER_HARDWARE


def _is_same(one: Sequence[SensorModel], other: Sequence[SensorModel]) -> bool:
    """Whether two rigs have the same models, each in the same number."""
    left = list(other)
    for model in one:
        match = next((k for k, each in enumerate(left) if same_model(model, each)), None)
        if match is None:
            return False
        del left[match]
    return not left

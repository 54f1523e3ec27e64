"""The share of a camera's picture that the vehicle hides, by part."""

import numpy as np
import pytest

import pe_core as pe
from tests.engine import shapes


@pytest.mark.parametrize("samples", [0, 2048])
def test_a_wall_hides_the_left_half_of_the_picture(samples):
    """A wall from straight ahead to the left, one metre off, higher than the picture."""
    wall = pe.Vehicle(
        shapes.box((1.0, 0.0, 0.0), (1.1, 3.0, 4.0)), np.zeros(12, np.int32), ("wall",)
    )
    sensor = shapes.camera(60.0, (0.0, 0.0, 2.0))
    space = pe.PerceptionSpace((-2, 8), (-4, 4), (0, 4), 0.5)
    score = pe.Evaluator(space, pe.Prior.uniform(), wall, samples=samples).score(pe.Rig([sensor]))
    own = score.per_sensor["camera"]
    assert own.occluded / own.beams == pytest.approx(0.5, abs=0.01)
    assert own.occluded_by == {"wall": own.occluded}
    assert 16_000 < own.beams <= 16_384

"""Regions on a grid: opened, closed, without specks, smoothed; against plain loops."""

import numpy as np
import pytest

from pe_core.scoring.sight.grid_regions import closed, gauss, opened, without_specks


def flooded(flags):
    """Pieces connected by sides, found cell by cell."""
    left = {tuple(cell) for cell in np.argwhere(flags).tolist()}
    while left:
        todo = [left.pop()]
        piece = list(todo)
        while todo:
            i, j = todo.pop()
            for cell in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
                if cell in left:
                    left.remove(cell)
                    todo.append(cell)
                    piece.append(cell)
        yield piece


def test_opening_keeps_what_a_disc_fits_into():
    flags = np.zeros((12, 12), bool)
    flags[2:5, 2:10] = True  # three cells wide
    flags[7:9, 2:10] = True  # two
    flags[3, 10] = True  # a spur of one
    expected = np.zeros_like(flags)
    expected[2:5, 2:10] = True
    assert np.array_equal(opened(flags, 1.5), expected)
    assert np.array_equal(closed(~flags, 1.5), ~expected)


def test_beyond_the_edge_a_region_goes_on():
    flags = np.zeros((8, 8), bool)
    flags[:, :1] = True
    assert np.array_equal(opened(flags, 1.5), flags)
    assert np.array_equal(opened(flags.T, 1.5), flags.T)


@pytest.mark.parametrize("radius", [0.0, 0.9, 1.0, 1.5, 2.3])
def test_opening_is_the_union_of_discs_that_fit(radius):
    rng = np.random.default_rng(2)
    flags = rng.random((15, 18)) < 0.85
    whole = np.pad(flags, 6, mode="edge")
    i, j = np.indices(whole.shape)
    union = np.zeros_like(whole)
    for at in np.argwhere(whole[3:-3, 3:-3]) + 3:
        disc = (i - at[0]) ** 2 + (j - at[1]) ** 2 <= radius**2
        if whole[disc].all():
            union |= disc
    assert np.array_equal(opened(flags, radius), union[6:-6, 6:-6])


@pytest.mark.parametrize("share", [0.3, 0.5, 0.6, 0.8])
def test_specks_are_pieces_of_few_cells(share):
    rng = np.random.default_rng(int(share * 10))
    for least in (0.5, 2, 5, 20):
        flags = rng.random((23, 31)) < share
        expected = np.zeros_like(flags)
        for piece in flooded(flags):
            if len(piece) >= least:
                expected[tuple(np.transpose(piece))] = True
        assert np.array_equal(without_specks(flags, least), expected)


def test_a_long_way_round_is_one_piece():
    """A spiral: its ends know nothing of each other but through all of it."""
    flags = np.zeros((41, 41), bool)
    i = j = 0
    for turn, length in enumerate(n for k in range(40, 1, -2) for n in (k, k)):
        di, dj = ((0, 1), (1, 0), (0, -1), (-1, 0))[turn % 4]
        for _ in range(length):
            flags[i, j] = True
            i, j = i + di, j + dj
    assert len(list(flooded(flags))) == 1
    assert np.array_equal(without_specks(flags, flags.sum()), flags)
    assert not without_specks(flags, flags.sum() + 1).any()


def test_nothing_and_everything():
    assert not without_specks(np.zeros((3, 4), bool), 1).any()
    assert without_specks(np.ones((3, 4), bool), 12).all()


def test_smoothing_is_a_gauss_curve_both_ways():
    values = np.zeros((21, 25))
    values[9, 12] = 1.0
    found = gauss(values, 2.0)
    i, j = np.indices(values.shape)
    square = (i - 9) ** 2 + (j - 12) ** 2
    near = (abs(i - 9) <= 4) & (abs(j - 12) <= 4)
    assert found == pytest.approx(np.where(near, np.exp(-square / 8.0), 0.0))
    assert np.array_equal(gauss(values, 0.4), values)

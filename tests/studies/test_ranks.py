"""Rank correlation with all permutations: against figures by hand and against brute force."""

import itertools
import math

import numpy as np
import pytest

from studies.ranks import (
    exact_p,
    exact_p_of_mean,
    holm,
    midranks,
    min_significant_rho,
    spearman,
    under_chance,
)


def test_equal_values_share_their_rank():
    assert midranks([3.0, 1.0, 3.0, 2.0]).tolist() == [3.5, 1.0, 3.5, 2.0]


def test_rho_by_hand():
    """Without ties 1 - 6 sum d^2 / (n (n^2 - 1)); d = 1, -1, 0, 0, 0."""
    assert spearman([1, 2, 3, 4, 5], [2, 1, 3, 4, 5]) == pytest.approx(1 - 6 * 2 / (5 * 24))
    assert spearman([1, 2, 3, 4], [4, 3, 2, 1]) == pytest.approx(-1.0)


def test_rho_with_ties_is_the_correlation_of_midranks():
    a = [1, 2, 2, 4, 5]
    b = [3, 1, 4, 4, 9]
    expected = np.corrcoef(midranks(a), midranks(b))[0, 1]
    assert spearman(a, b) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(("count", "least"), [(5, 1.0), (6, 0.886), (7, 0.786), (8, 0.738)])
def test_critical_values_are_the_tables(count, least):
    """Two-sided 5 %, as in tables of Spearman's rho (Zar 1972)."""
    assert min_significant_rho(count) == pytest.approx(least, abs=5e-4)


def test_chance_is_the_mean_over_detectors_of_shuffled_placements():
    score = [1.0, 2.0, 2.0, 5.0]
    aims = [[1.0, 3.0, 2.0, 4.0], [2.0, 1.0, 4.0, 4.0]]
    expected = sorted(
        np.mean([spearman([score[i] for i in order], aim) for aim in aims])
        for order in itertools.permutations(range(4))
    )
    assert under_chance(score, aims) == pytest.approx(expected, abs=1e-12)


def test_p_of_the_mean_over_two_papers_is_the_share_of_all_pairs_of_orders():
    rng = np.random.default_rng(3)
    first = under_chance([1, 2, 3, 4], [rng.normal(size=4).tolist() for _ in range(3)])
    second = under_chance([1, 2, 2, 4, 5], [rng.normal(size=5).tolist()])
    sums = [(a + b) / 2 for a in first for b in second]
    for observed in (0.0, 0.31, -0.55, sums[100], max(sums)):
        expected = np.mean([abs(s) >= abs(observed) - 1e-9 for s in sums])
        assert exact_p_of_mean(observed, first, second) == pytest.approx(min(1.0, expected))


def test_p_is_two_sided():
    chance = under_chance([1, 2, 3, 4, 5], [[1, 2, 3, 4, 5]])
    assert exact_p(1.0, chance) == pytest.approx(2 / math.factorial(5))
    assert exact_p(0.0, chance) == 1.0


def test_holm_by_hand():
    """0.01 x 4; 0.02 x 3; 0.03 x 2, not below the one before; 0.5 x 1."""
    assert holm([0.03, 0.01, 0.5, 0.02]) == pytest.approx([0.06, 0.04, 0.5, 0.06])

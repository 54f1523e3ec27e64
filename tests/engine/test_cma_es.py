"""CMA-ES: the released file, samples that do not hang on LAPACK, and no bound told as a value."""

import hashlib
import math
from importlib.resources import files

import numpy as np
import pytest

import pe_core as pe
from pe_core.search import Evaluation, Parametrization
from pe_core.search.methods import Given
from pe_core.search.methods.cma_es import Evolution, SymmetricCma
from pe_core.search.methods.method import Phase
from tests.engine import mounting
from tests.engine.mounting import can, roof

RELEASED = {
    "_cma.py": "a0f27c93e7a6b1dffd1097fa4adcc2026b396adcc50d21b8121edb01228a5be5",
    "LICENSE": "f37ff0eaa67cd538d2fac0e5868e412bd17973d3261ec8ff7e8116dc69eab695",
}
"""SHA-256 of the two files in cmaes-0.13.1-py3-none-any.whl of the Python package index."""


@pytest.mark.parametrize(("name", "digest"), RELEASED.items())
def test_the_file_of_the_package_cmaes_and_its_licence_are_as_released(name, digest):
    data = files("pe_core").joinpath("search", "_vendor", "cmaes", name).read_bytes()
    assert hashlib.sha256(data).hexdigest() == digest


def test_samples_do_not_depend_on_which_eigenvectors_are_found(monkeypatch):
    """Where eigenvalues are equal, LAPACKs differ: here each eigenvector is turned round."""

    def asked():
        cma = SymmetricCma(np.zeros(3), 0.5, seed=1, population_size=6)
        for _ in range(4):
            points = [cma.ask() for _ in range(6)]
            cma.tell([(p, float(np.round(p @ p, 9))) for p in points])
        return np.array([cma.ask() for _ in range(5)])

    plain, eigh = asked(), np.linalg.eigh
    monkeypatch.setattr(np.linalg, "eigh", lambda c: (eigh(c)[0][::-1], -eigh(c)[1][:, ::-1]))
    assert asked() == pytest.approx(plain, abs=1e-12)


def given_on_the_car(**options):
    rig, space = mounting.space(can(), **options)
    coding = Parametrization(rig, space)
    return Given(coding, coding.start, 1.0, seed=3)


def test_no_lower_bound_is_ranked_before_an_entropy():
    """Of the later half only what is below the worst of the first half is told as it is."""
    given = given_on_the_car()
    evolution = Evolution(given, given.parametrization.blocks[0], given.start, [1])
    asking, told = evolution.evaluate(given.start, Phase(0, 8)), []
    evolution._cma.tell = told.extend
    question = next(asking)
    assert question.cutoff == math.inf and len(question.candidates) == 4
    question = asking.send([Evaluation(v, False) for v in (4.0, 2.0, 3.0, 1.0)])
    assert question.cutoff == 4.0 and len(question.candidates) == 4
    answers = [Evaluation(4.0, True), Evaluation(0.5, False), Evaluation(9.0, True), None]
    with pytest.raises(StopIteration):
        asking.send(answers)
    assert [value for _, value in told] == [4.0, 2.0, 3.0, 1.0, 4.0, 0.5, 4.0, math.inf]


def test_every_candidate_is_in_its_range_and_keeps_to_the_rules():
    """Two metres of steps on a roof of 2.3 m with a hatch in it."""
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(-0.2, 3.0))])
    given = given_on_the_car(mount={"roof": roof()}, constraints=limits)
    evolution = Evolution(given, given.parametrization.blocks[0], given.start, [1])
    evolution._cma._sigma = 2.0
    asking = evolution.evaluate(given.start, Phase(0, 8))
    question = next(asking)
    found = [c for c in question.candidates if c is not None]
    assert len({c.vector for c in found}) == len(found) >= 3
    for candidate in found:
        assert not given.parametrization.broken(candidate.rig)
        for unknown, value in zip(given.parametrization.variables, candidate.vector, strict=True):
            assert unknown.low - 1e-9 <= value <= unknown.high + 1e-9

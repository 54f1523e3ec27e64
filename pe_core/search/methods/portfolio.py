"""Portfolio, the default: surveys of each sensor, then a race of descents by steps of all lengths.

Surveys find the region: each sensor tries places all over its range, the others kept. Descents that
share nothing but their start race then; the best of them goes on to the end, with surveys between.
A large budget ends on more voxels: those of the search screen candidates then.
Sensors of one model are tried beside images of each other, too.
Sensors on lists of slots try all slots, exchange them, and move two at a time.
"""

from ...scoring.sampling import MAX_SAMPLES
from ..objective import Value
from .method import Given, Incumbent, MethodPart, Phase, QuestionStream
from .portfolio_steps import EXPLORING, REFINING, MultiscaleDescent
from .portfolio_survey import Survey, to_best_corners

FEW = (0, 375, 900, 1200)
PER_SENSOR = 375
"""Placements where no budget is given: for none to three sensors that move, and for each of
more."""
COARSENING = 4
MIN_SAMPLES = 2048
"""The first level evaluates a fourth of the voxels, but at least so many; the third evaluates four
times as many."""
BELOW_GRID = 65_536
"""Where the last level is the grid, the first level is as if the last had so many voxels."""
RACING = 4
PLACEMENTS_PER_START = 80
"""Descents that race, but only one for each so many placements for each sensor. A budget for all of
them is large: it comes so near an optimum that small steps and errors of the sample matter."""
FIRST_LEVEL = 0.4
RACE_SHARE = 0.08
"""Share of the budget after which the first level ends; share of what is left then for each descent
of the race, and twice that for each of the better half."""
SURVEYS = 2
SURVEYED = 6
"""Surveys before the first descent, and places that each of them tries for each sensor,"""
SURVEY_SHARE = 0.3
"""but at most this share of the budget in all."""
NEAR = 0.3
NEAR_COUNT = 3
"""Reach of the surveys between descents, as a share of each range, and places for each sensor."""
STEP_SHARE = 0.5
LAST_STEPS = 30
"""After a race: share of the budget that is left for steps between two surveys, and the number of
placements a sensor, from which on it is all that is left."""
STALLED = 8
"""A search of slots alone ends after so many batches of two moved that found nothing better."""


def samples(count: int, evaluations: int, sensors: int) -> tuple[int, ...]:
    """Return how many voxels each level evaluates. The second has as many as the study sets; a
    third is for large budgets, as a search on a sample overestimates its own result."""
    most = count or BELOW_GRID
    first = max(most // COARSENING, min(MIN_SAMPLES, most))
    if not count or _runners(evaluations or default_budget(sensors), sensors) < RACING:
        return first, count
    return first, count, min(COARSENING * count, MAX_SAMPLES)


def default_budget(sensors: int) -> int:
    """Return how many placements are evaluated where no budget is given."""
    return FEW[sensors] if sensors < len(FEW) else PER_SENSOR * sensors


def _runners(total: int, sensors: int) -> int:
    """Return how many descents race."""
    return min(RACING, max(1, total // (PLACEMENTS_PER_START * sensors)))


def ask(given: Given) -> QuestionStream:
    """Survey on few voxels; then descend on all voxels of the search until the budget is spent."""
    sensors = len(given.parametrization.blocks)
    total = given.evaluations or default_budget(sensors)
    incumbent = Incumbent(given.start, given.value)
    survey = Survey(given)
    count = max(1, min(SURVEYED, int(SURVEY_SHARE * total / (SURVEYS * sensors))))
    for _ in range(SURVEYS):
        yield from survey.survey(incumbent, Phase(0, total), count)
        survey.reseed()
    steps = None
    ends = tuple[Value, ...]()
    if not survey.has_slots_alone:
        incumbent, steps, ends = yield from _race(given, incumbent, survey, total, surveyed=count)
    else:
        for level in range(1, given.levels):
            yield from incumbent.raised(Phase(1, total, level), level > 1)
    number = 1
    stalled = 0
    while incumbent.count < total and stalled < STALLED:
        before = incumbent.count, incumbent.value
        phase = Phase(number, total, given.levels - 1, ends)
        if steps is None:
            yield from survey.two_moved(incumbent, phase)
            stalled = 0 if incumbent.value < before[1] else stalled + 1
        else:
            left = total - incumbent.count
            share = STEP_SHARE if left > LAST_STEPS * sensors else 1.0
            yield from steps.descend(incumbent, phase, share * left)
        if not stalled:
            yield from survey.survey(incumbent, phase, NEAR_COUNT, NEAR)
            yield from survey.images(incumbent, phase)
        if incumbent.count == before[0]:
            return  # nothing can move
        number += 1


def _race(
    given: Given, incumbent: Incumbent, survey: Survey, total: int, surveyed: int
) -> MethodPart[tuple[Incumbent, MultiscaleDescent, tuple[Value, ...]]]:
    """Race descents from the best of the surveys and from the start, in turn.

    All but two have a survey of their own first; in all of them each sensor tries its corners. The
    race goes on on the voxels of the search: a fourth of them cannot tell apart optima that differ
    by less than 0.05 nats. The better half goes on to the last level. Returns the winner, its
    steps, and where each descent ended; a small budget has one descent, which tells nothing.
    """
    first = Phase(0, total)
    last = Phase(1, total, given.levels - 1)
    second = Phase(1, total, min(1, last.level))
    runners = _runners(total, len(given.parametrization.blocks))
    stride = REFINING if runners == RACING else EXPLORING
    racing = list[tuple[Incumbent, MultiscaleDescent]]()
    before = incumbent.count
    for k in range(runners):
        if k % 2:
            own = Incumbent(given.start, given.value)
        else:
            own = Incumbent(incumbent.best, incumbent.value)
        if k > 1:
            yield from survey.survey(own, first, surveyed)
        yield from to_best_corners(given, own, first)
        racing.append((own, MultiscaleDescent(given, [given.seed, k], stride)))
    used = before + sum(own.count for own, _ in racing)
    for own, steps in racing:
        yield from steps.descend(own, first, (FIRST_LEVEL * total - used) / runners)
    if second.level > 0:
        for own, _ in racing:
            yield from own.raised(second)
    left = total - before - sum(own.count for own, _ in racing)
    yield from _go_on(racing, survey, second, RACE_SHARE * left)
    finalists = sorted(racing, key=lambda each: each[0].value)[: max(1, runners // 2)]
    if last.level > second.level:
        for own, _ in finalists:
            yield from own.raised(last, screening=True)
    if runners > 2:
        yield from _go_on(finalists, survey, last, 2.0 * RACE_SHARE * left)
    winner, steps = min(finalists, key=lambda each: each[0].value)
    ends = tuple(own.value for own, _ in racing) if runners > 1 else ()
    winner.count = before + sum(own.count for own, _ in racing)
    return winner, steps, ends


def _go_on(
    racing: list[tuple[Incumbent, MultiscaleDescent]], survey: Survey, phase: Phase, count: float
) -> MethodPart[None]:
    """Let each descent try images, and then so many steps."""
    for own, steps in racing:
        yield from survey.images(own, phase)
        yield from steps.descend(own, phase, count)

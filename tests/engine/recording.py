"""Evaluators that score by a formula and write down what they were asked: searches run on them."""

import math

from pe_core.search import AXES, pose_values


class Recorder:
    """Scores a rig by a function of its poses; keeps every rig, its value and what it was told.

    Duck-typed: what an `Objective` asks of a figure, and nothing else. With `bounds`, candidates
    that are no better than what they have to be below are answered by inf.
    """

    def __init__(self, landscape, bounds=False):
        self.landscape = landscape
        self.bounds = bounds
        self.rigs = []
        self.values = []
        self.cutoff = []

    def __call__(self, rig):
        return self.below(rig, math.inf)

    def below(self, rig, cutoff):
        value = self.landscape(rig)
        self.rigs.append(rig)
        self.values.append(value)
        self.cutoff.append(cutoff)
        return math.inf if self.bounds and value >= cutoff else value

    def of(self, sensor):
        """Coordinates of one sensor in every rig asked for, by axis: metres and radians."""
        asked = [pose_values(rig[sensor].pose) for rig in self.rigs]
        return {axis: [values[axis] for values in asked] for axis in AXES}


def distance_to(target):
    """A landscape: how far every sensor is from a target (axis -> value), 1 m weighing as 1 rad."""

    def landscape(rig):
        return sum(
            (pose_values(sensor.pose)[axis] - value) ** 2
            for sensor in rig
            for axis, value in target.items()
        )

    return landscape


def flat(_):
    """A landscape where every placement is as good as any other."""
    return 1.0

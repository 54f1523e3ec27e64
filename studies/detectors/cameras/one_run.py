"""One run of the study of cameras: scenes are rendered, a detector is trained and tested."""

from __future__ import annotations

import time
from typing import Any

from ..detector import Detector
from ..one_run import with_origin
from ..plan import SPLITS
from ..scenes import CLASSES
from ..training import results, test_scenes, timed_training
from .lifting import Lifting
from .network import pictures_network
from .plan import CameraPlan
from .rendering import Renderer
from .study import CameraRun


def run_camera(plan: CameraPlan, run: CameraRun) -> dict[str, Any]:
    """Return the results of a run as JSON data."""
    started = time.process_time()
    study, rule = plan.study, plan.study.training
    renderer = Renderer(plan, run.placement)
    train, validation, test = (
        [renderer.pictures(split, number) for number in range(plan.scenes[split])]
        for split in SPLITS
    )
    network = pictures_network(Lifting.of(plan, run.placement), len(CLASSES))
    detector = Detector(network, rule.rate, rule.average)
    trained, training = timed_training(detector, study, train, validation, run.seed)
    found = results(study, test, test_scenes(detector, trained.weights, study, test))
    return with_origin({**found, "training": training}, run.name, plan.digest, started)

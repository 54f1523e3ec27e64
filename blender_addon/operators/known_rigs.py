"""What a good score is: that of the known rigs on the same body, in the background."""

import json
import math

import bpy

from .. import signals
from ..engine import pe, scoring
from ..processes import engine_calls, engine_process


def request(scene: bpy.types.Scene, study: pe.Study, surroundings: str) -> None:
    """Have the known rigs scored on a study's vehicle, once for its surroundings."""
    name = scene.name
    if json.loads(scene.perception_entropy.known_rigs_json or "{}").get("of") == surroundings:
        return

    def deliver(entropies: dict[str, tuple[float, float]]) -> None:
        if (found := bpy.data.scenes.get(name)) is not None:
            told = {"of": surroundings, "entropies": entropies}
            found.perception_entropy.known_rigs_json = json.dumps(told)
            signals.live_score_changed.emit()

    topic = f"known rigs of {name}"
    engine_process.ask(topic, engine_calls.known_entropies, (study,), deliver, fail=lambda _: None)


def told(scene: bpy.types.Scene) -> str:
    """Return how many known rigs the stored score is better than, beyond the standard errors of
    the differences; empty where it is not known. Errors are taken as independent, which
    overestimates them on a common sample."""
    settings = scene.perception_entropy
    entropies = json.loads(settings.known_rigs_json or "{}").get("entropies", {}).values()
    if not entropies or not settings.has_result:
        return ""
    result = settings.result
    worse = 0
    for entropy, stderr in entropies:
        by = entropy - result.entropy
        error = math.hypot(stderr, result.stderr)
        worse += by > 0.0 and not scoring.is_noise(by, error)
    return f"Better than {worse} of {len(entropies)} known rigs"

"""Computing results once more, to see whether the engine still says the same to the last bit."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from pe_core.text import dump_json

from .effort import from_dict
from .plan import scores_and_figures
from .tasks import function_of


def differences(data: Mapping[str, Any], tell: Callable[[str], None]) -> tuple[int, list[str]]:
    """Compute every score and figure that needs no search, and compare it with results.json.

    Returns
    -------
    compared : int
        Results that were computed again.
    unlike : list of str
        A line for each that is not equal in every digit.
    """
    tasks = scores_and_figures(from_dict(data["made"]["effort"]))
    unlike = []
    for done, task in enumerate(tasks, 1):
        value = json.loads(dump_json(function_of(task.function)(**task.arguments)))
        same = value == data["results"][task.name]["value"]
        tell(f"[{done}/{len(tasks)}] {task.name}  {'equal' if same else 'NOT EQUAL'}")
        if not same:
            unlike.append(f"not equal: {task.name}")
    return len(tasks), unlike

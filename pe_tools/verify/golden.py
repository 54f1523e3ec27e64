"""All golden cases, a row each."""

from functools import lru_cache

from .golden_case import GoldenCase
from .golden_metric import frame_cases, metric_cases, prior_cases, score_cases
from .golden_search import search_cases, verdict_cases
from .golden_sensors import camera_cases, echo_cases, lidar_cases, occlusion_cases

TABLES = (
    metric_cases,
    frame_cases,
    prior_cases,
    lidar_cases,
    camera_cases,
    occlusion_cases,
    echo_cases,
    score_cases,
    verdict_cases,
    search_cases,
)


@lru_cache(maxsize=1)
def golden_cases() -> tuple[GoldenCase, ...]:
    """Return all cases, the cheap ones first."""
    return tuple(case for table in TABLES for case in table())

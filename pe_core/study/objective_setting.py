"""The setting `objective` of `[optimize]`: what a search improves."""

from ..base.setting import OneOf, Panel, setting

ENTROPY, EXPECTED_AP = "entropy", "expected_ap"
OBJECTIVES = (ENTROPY, EXPECTED_AP)
OBJECTIVE: str = setting(
    ENTROPY,
    OneOf(OBJECTIVES),
    "What a search improves: the entropy, or the expected AP of objects in traffic",
    Panel(
        "objective",
        "Objective",
        menu=(
            ("Entropy", "Lower the entropy of the targets: voxels or objects"),
            ("Expected AP in Traffic", "Raise the expected AP of objects that occlude each other"),
        ),
    ),
)
"""The field of `Search`."""

"""How a sensor takes its frames in time: when they begin, and which way a scan turns."""

from dataclasses import dataclass

from ..base.setting import OneOf, Panel, check_settings, setting
from ..base.values import Number, Whole

UNKNOWN, LEFT, RIGHT, AT_ONCE = "unknown", "left", "right", "at_once"
SENSE = {LEFT: 1.0, RIGHT: -1.0, AT_ONCE: 0.0}


@dataclass(frozen=True, slots=True)
class ScanTiming:
    """Direction, phase and exposures of a sensor's frames. They change no score.

    `InputError` when one is impossible.
    """

    turns: str = setting(
        UNKNOWN,
        OneOf((UNKNOWN, *SENSE)),
        "Which way a LiDAR's scan turns, seen from above",
        Panel(
            "scan_turns",
            "Scan Turns",
            menu=(
                ("Unknown", "The worse of both ways; no seam is computed"),
                ("Left", "Counter-clockwise"),
                ("Right", "Clockwise"),
                ("At Once", "The whole frame at one time: a flash"),
            ),
        ),
    )
    phase: float = setting(
        0.0,
        Number(0.0, 1.0, noun="phase"),
        "Share of a frame from the common clock to this exposure, or to azimuth 0 of this scan",
        Panel("scan_phase", "Phase", precision=3),
    )
    exposures: int = setting(
        1,
        Whole(1, 100),
        "Frames until a LiDAR's pattern repeats: in a drive-by its channels are shared out to so "
        "many frames, in their order",
        Panel("scan_exposures", "Exposures", soft_max=20),
    )

    def __post_init__(self) -> None:
        check_settings(self, "sensor")

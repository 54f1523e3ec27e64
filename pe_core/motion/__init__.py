"""Time: scenarios of what moves round the vehicle, tracks, and when they are confirmed."""

from ..lazy_faces import lazy_face

with lazy_face(__name__):
    from ..metric.frames import RATE_HZ, Frames
    from .drive_by import DriveBy, Moment, SeenBody, drive_by
    from .scenario import CHANCE, Actor, Scenario, checked_scenarios, scenarios
    from .tracks import CORRELATION_TIME_S, WINDOW, Confirmation

"""Radars: the detections that are expected of objects, and the vehicle that hides them."""

from .detection import Reflectivity, detection_probability, signal_to_noise, snr_for
from .kind import RADAR
from .model import Radar, RadarMode

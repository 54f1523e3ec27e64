"""Ultrasonic sensors: whether an echo comes back."""

from .kind import ULTRASONIC
from .model import Ultrasonic

__all__ = ["ULTRASONIC", "Ultrasonic"]

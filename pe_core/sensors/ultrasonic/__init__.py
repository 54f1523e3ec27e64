"""Ultrasonic sensors: whether an echo comes back."""

from .definition import Ultrasonic
from .kind import ULTRASONIC

__all__ = ["ULTRASONIC", "Ultrasonic"]

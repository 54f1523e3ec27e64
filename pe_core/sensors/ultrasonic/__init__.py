"""Ultrasonic sensors: whether an echo comes back."""

from .kind import ULTRASONIC, Ultrasonic

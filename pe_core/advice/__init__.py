"""In words a designer uses: a place asked about, warnings, a score in words, several compared."""

from .advice import Advice
from .phrases import sensor_words, words
from .place import AskedPlace, SensorAtPlace, ask_place
from .side_by_side import ComparedRow, compare
from .told import warnings

__all__ = [
    "Advice",
    "AskedPlace",
    "ComparedRow",
    "SensorAtPlace",
    "ask_place",
    "compare",
    "sensor_words",
    "warnings",
    "words",
]

"""In words a designer uses: a place asked about, warnings, a score in words, several compared."""

from .advice import FRAGILE, Advice
from .fragile import fragile, off_by
from .mounting import stopped_shares
from .object_words import object_words, objects_looked_at
from .outlook import Outlook, class_of, outlook
from .phrases import WHERE, sensor_words, stopped_words, words
from .place import AskedPlace, SensorAtPlace, ask_place
from .side_by_side import ComparedRow, compare
from .told import warnings
from .vehicle_line import vehicle_line

__all__ = [
    "FRAGILE",
    "WHERE",
    "Advice",
    "AskedPlace",
    "ComparedRow",
    "Outlook",
    "SensorAtPlace",
    "ask_place",
    "class_of",
    "compare",
    "fragile",
    "object_words",
    "objects_looked_at",
    "off_by",
    "outlook",
    "sensor_words",
    "stopped_shares",
    "stopped_words",
    "vehicle_line",
    "warnings",
    "words",
]

"""In words a designer uses: a place asked about, warnings, a score in words, several compared."""

from .advice import FRAGILE, Advice
from .figures import joined
from .fragile import fragile, off_by
from .hidden import HiddenSensor, hidden_sensors, hidden_words
from .key_figures import KeyFigures, key_figures
from .mounting import stopped_shares
from .object_words import lone_reach, object_words, objects_looked_at
from .outlook import BLIND_TO_M, Outlook, class_of, outlook
from .phrases import WHERE, rig_words, sensor_words, stopped_words, words
from .place import AskedPlace, SensorAtPlace, ask_place
from .ranking import Notation, ranking, win_words
from .sensor_table import (
    SENSOR_COLUMNS,
    SHORT_ZONES,
    SensorRow,
    loss_text,
    sensor_rows,
    sensor_table,
)
from .side_by_side import ComparedRow, compare, compare_figures
from .told import warnings
from .vehicle_line import vehicle_line

__all__ = [
    "BLIND_TO_M",
    "FRAGILE",
    "SENSOR_COLUMNS",
    "SHORT_ZONES",
    "WHERE",
    "Advice",
    "AskedPlace",
    "ComparedRow",
    "HiddenSensor",
    "KeyFigures",
    "Notation",
    "Outlook",
    "SensorAtPlace",
    "SensorRow",
    "ask_place",
    "class_of",
    "compare",
    "compare_figures",
    "fragile",
    "hidden_sensors",
    "hidden_words",
    "joined",
    "key_figures",
    "lone_reach",
    "loss_text",
    "object_words",
    "objects_looked_at",
    "off_by",
    "outlook",
    "ranking",
    "rig_words",
    "sensor_rows",
    "sensor_table",
    "sensor_words",
    "stopped_shares",
    "stopped_words",
    "vehicle_line",
    "warnings",
    "win_words",
    "words",
]

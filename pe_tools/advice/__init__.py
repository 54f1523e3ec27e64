"""Texts for the designer of a rig: warnings, scores in words, comparisons, and one location.

Nothing here computes a score; results of `pe_core` are checked, compared and described.
"""

from pe_core.scoring.sight import BLIND_TO_M
from pe_tools.advice.advice import joined, percent

from .advice import FRAGILE, PROVISIONAL, UNMET, Advice, fragile, off_by, unmet
from .condition_checks import condition_warnings
from .curve_checks import curve_note, curve_warnings
from .hardware import OTHER_HARDWARE, hardware_note
from .key_figures import (
    SENSOR_COLUMNS,
    SHORT_ZONES,
    KeyFigures,
    SensorRow,
    key_figures,
    loss_text,
    sensor_rows,
    sensor_table,
)
from .location import AskedPlace, SensorAtPlace, ask_place
from .mount_checks import check_mirror_image, occluded_shares
from .mounting_places import place_name, plain_name, sensor_labels
from .ranking import Notation, ranking, win_words
from .score_comparison import ComparedRow, compare, compare_figures
from .search_cost import costs_nothing, search_cost
from .summary import (
    Outlook,
    class_of,
    lone_reach,
    object_words,
    objects_looked_at,
    outlook,
)
from .summary_text import WHERE, occluded_words, rig_words, sensor_words, words
from .warnings import HiddenSensor, hidden_sensors, hidden_words, warnings

__all__ = [
    "BLIND_TO_M",
    "FRAGILE",
    "OTHER_HARDWARE",
    "PROVISIONAL",
    "SENSOR_COLUMNS",
    "SHORT_ZONES",
    "UNMET",
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
    "check_mirror_image",
    "class_of",
    "compare",
    "compare_figures",
    "condition_warnings",
    "costs_nothing",
    "curve_note",
    "curve_warnings",
    "fragile",
    "hardware_note",
    "hidden_sensors",
    "hidden_words",
    "joined",
    "key_figures",
    "lone_reach",
    "loss_text",
    "object_words",
    "objects_looked_at",
    "occluded_shares",
    "occluded_words",
    "off_by",
    "outlook",
    "percent",
    "place_name",
    "plain_name",
    "ranking",
    "rig_words",
    "search_cost",
    "sensor_labels",
    "sensor_rows",
    "sensor_table",
    "sensor_words",
    "unmet",
    "warnings",
    "win_words",
    "words",
]

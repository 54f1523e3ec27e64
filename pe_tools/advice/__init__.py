"""Texts for the designer of a rig: warnings, scores in words, comparisons, and one location.

Nothing here computes a score; results of `pe_core` are checked, compared and described.
"""

from pe_core.scoring.sight import BLIND_TO_M as BLIND_TO_M
from pe_tools.wording import joined as joined
from pe_tools.wording import percent as percent

from ..wording import off_by as off_by
from .advice import FRAGILE as FRAGILE
from .advice import PROVISIONAL as PROVISIONAL
from .advice import UNMET as UNMET
from .advice import Advice as Advice
from .advice import fragile as fragile
from .advice import unmet as unmet
from .key_figures import KeyFigures as KeyFigures
from .key_figures import SensorRow as SensorRow
from .key_figures import key_figures as key_figures
from .key_figures import loss_text as loss_text
from .key_figures import sensor_rows as sensor_rows
from .key_figures import sensor_table as sensor_table
from .location import AskedPlace as AskedPlace
from .location import SensorAtPlace as SensorAtPlace
from .location import ask_place as ask_place
from .mount_checks import check_mirror_image as check_mirror_image
from .mount_checks import occluded_shares as occluded_shares
from .mounting_places import place_name as place_name
from .mounting_places import plain_name as plain_name
from .mounting_places import sensor_labels as sensor_labels
from .ranking import Notation as Notation
from .ranking import costs_nothing as costs_nothing
from .ranking import ranking as ranking
from .ranking import search_cost as search_cost
from .ranking import win_words as win_words
from .score_comparison import OTHER_HARDWARE as OTHER_HARDWARE
from .score_comparison import ComparedRow as ComparedRow
from .score_comparison import compare as compare
from .score_comparison import compare_figures as compare_figures
from .score_comparison import hardware_note as hardware_note
from .summary import Outlook as Outlook
from .summary import class_of as class_of
from .summary import lone_reach as lone_reach
from .summary import object_words as object_words
from .summary import objects_looked_at as objects_looked_at
from .summary import outlook as outlook
from .summary_text import WHERE as WHERE
from .summary_text import occluded_words as occluded_words
from .summary_text import rig_words as rig_words
from .summary_text import sensor_words as sensor_words
from .summary_text import words as words
from .warnings import condition_warnings as condition_warnings
from .warnings import curve_note as curve_note
from .warnings import curve_warnings as curve_warnings
from .warnings import hidden_sensors as hidden_sensors
from .warnings import hidden_words as hidden_words
from .warnings import warnings as warnings

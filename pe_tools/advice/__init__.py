"""Texts for the designer of a rig: warnings, scores in words, comparisons, and one location.
Nothing here computes a score; results of `pe_core` are checked, compared and described."""

from pe_core.lazy_faces import lazy_face

with lazy_face(__name__):
    from pe_core.base.values import error_text
    from pe_core.search import KeyFigures
    from pe_tools.wording import joined, percent
    from ..wording import off_by
    from .as_built import AsBuilt, BuiltPair, Pairing, built_sensor_lines, built_table
    from .as_built import pair_text
    from .as_built import fallen_verdicts, paired
    from .advice import FRAGILE, NOT_KEPT, UNMET, Advice, fragile, not_kept, unmet
    from .differences import Worth, worth_lines, worth_rows
    from .free_region import EDGE, FreeRegion, Limitation, Way, region_lines, usual_loss
    from .flatness import Flatness, flatness_lines, flatness_of
    from .body_sight import BodySight, StandingBody, see_bodies
    from .key_figures import SensorRow, loss_text, sensor_rows, sensor_table
    from .key_figures import built_lines
    from .kriging import Kriging
    from .location import AskedPlace, SensorAtPlace, ask_place
    from .mount_checks import check_mirror_image, nearest_point, occluded_shares
    from .mountable import Consensus, Rounding, SensorSpread, consensus_of
    from .ranking import (
        costs_nothing,
        disagreement,
        gain_sentence,
        moved_words,
        ranking,
        search_cost,
    )
    from .score_comparison import OTHER_HARDWARE, TRAFFIC, ComparedRow, compare
    from .score_comparison import compare_figures, difference_error, hardware_note
    from .steepest_way import BetterPlace, Slope, SteepestWay, steepest_lines, steepest_steps
    from .steepest_way import places_of, screen_of, steepest_way, way_text
    from .summary import (
        WHERE,
        Outlook,
        class_of,
        lone_reach,
        object_words,
        objects_looked_at,
        outlook,
    )
    from .summary import rig_words
    from .warnings import (
        condition_warnings,
        curve_note,
        curve_warnings,
        hidden_sensors,
        hidden_words,
    )
    from .warnings import warnings

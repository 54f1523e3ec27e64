"""What is stored on the scene: the study's settings, and a small summary of the last result."""

from __future__ import annotations

import zlib

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..choices import PRIORS
from ..engine import pe, search
from .advanced import AdvancedSceneSettings
from .axles import AxleSettings
from .breakdown import PE_ResultPart
from .callbacks import changed, redraw
from .focus import PE_FocusSettings
from .live import PE_LiveSettings
from .mounting import MountingSettings
from .selection import SelectionSettings
from .targets import TargetSettings
from .tolerance import ToleranceSettings
from .variants import PE_Variant
from .view import PE_ViewSettings
from .warnings import PE_Warning

METHODS = tuple(
    (name, method.label, method.about, 1 + zlib.crc32(name.encode()) % 2**30)
    for name, method in search.METHODS.items()
)
"""Of searches; a file holds a number that stays a method's whatever others there are."""
DEFAULT_CANDIDATES = 150
DEFAULT_BEAM_LIMIT = 5_000
DEFAULT_BEAM_LENGTH_M = 8.0
# Before 4.5 every path could be relative to the .blend file; since then a property has to say so.
PATH_OPTIONS = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()


class PE_SceneSettings(
    AdvancedSceneSettings,
    AxleSettings,
    MountingSettings,
    SelectionSettings,
    TargetSettings,
    ToleranceSettings,
    bpy.types.PropertyGroup,
):
    """The study's settings, and the last result."""

    version: IntProperty(
        name="Version",
        description="Of what is stored here; 0 is before there were versions, or not saved yet",
        min=0,
    )
    vehicle: PointerProperty(
        type=bpy.types.Collection,
        name="Vehicle",
        description="Collection of the vehicle's meshes: x forward, y left, z up, in metres, "
        "with the origin on the ground",
        update=changed,
    )
    prior: EnumProperty(
        items=PRIORS,
        name="Prior",
        description="Where objects are to be expected",
        update=changed,
    )
    boxes: StringProperty(
        name="Boxes",
        description="File of labelled boxes: KITTI's labels, nuScenes' JSON or CSV",
        subtype="FILE_PATH",
        options=PATH_OPTIONS,
        update=changed,
    )
    focus: CollectionProperty(
        type=PE_FocusSettings,
        name="Focus",
        description="What counts more than the prior says, or less",
    )
    focus_index: IntProperty(
        name="Selected Focus", description="Row of the list whose settings are shown", min=0
    )
    score_samples: IntProperty(
        name="Score Voxels",
        description="Voxels a score looks at; 0: all, 64 million",
        default=0,
        min=0,
        update=changed,
    )
    method: EnumProperty(
        items=METHODS,
        name="Method",
        description="How the search looks for better placements",
        default=search.DEFAULT_METHOD,
    )
    evaluations: IntProperty(
        name="Budget",
        description="Placements judged at most; 0: as many as the method takes",
        default=0,
        min=0,
        soft_max=10_000,
    )
    candidates: IntProperty(
        name="Candidates",
        description="Placements tried in each of the seven rounds of a search. The paper tries "
        "1000",
        default=DEFAULT_CANDIDATES,
        min=1,
        soft_max=1000,
    )
    search_samples: IntProperty(
        name="Search Voxels",
        description="Voxels a candidate is judged on; 0: all, 64 million",
        default=pe.Search().samples,
        min=0,
    )
    seed: IntProperty(
        name="Seed",
        description="The same seed finds the same placement",
        default=0,
        min=0,
    )

    live: PointerProperty(
        type=PE_LiveSettings, name="Live", description="The score that follows the hand"
    )

    show_overlay: BoolProperty(
        name="Show Perception",
        description="Show in the 3D view what the sensors see and miss",
        default=True,
        update=redraw,
    )
    beam_limit: IntProperty(
        name="Most Beams",
        description="Draw no more beams than this, evenly chosen; more make the view slow",
        default=DEFAULT_BEAM_LIMIT,
        min=1,
        soft_max=200_000,
        update=redraw,
    )
    beam_length: FloatProperty(
        name="Beam Length",
        description="How far beams are drawn that meet nothing",
        default=DEFAULT_BEAM_LENGTH_M,
        min=0.1,
        soft_max=200.0,
        subtype="DISTANCE",
        unit="LENGTH",
        update=redraw,
    )

    view: PointerProperty(
        type=PE_ViewSettings, name="View", description="What the 3D view shows of perception"
    )
    before_look: StringProperty(
        name="Before Looking",
        description="Camera and size of pictures before a sensor was looked through, as JSON",
    )

    views_before_look: StringProperty(
        name="Views Before Looking",
        description="3D views as they were before a sensor was looked through, as JSON",
    )

    has_result: BoolProperty(name="Has Result", description="A score is stored")
    result_kind: StringProperty(name="Kind", description="score or optimize")
    result_entropy: FloatProperty(
        name="Perception Entropy", description="In nats; lower is better. Rounded for display"
    )
    result_before: FloatProperty(
        name="Before", description="Perception entropy of the placement the search started from"
    )
    result_coverage: FloatProperty(
        name="Coverage", description="Share of the prior that some sensor sees, 0 to 1"
    )
    result_stderr: FloatProperty(
        name="Standard Error", description="Of the perception entropy; 0 when all voxels count"
    )
    result_json: StringProperty(
        name="Result", description="The last result in full, as result.json holds it"
    )
    result_signature: StringProperty(
        name="Signature", description="What was scored, to tell whether it still stands"
    )
    result_parts: CollectionProperty(
        type=PE_ResultPart, name="Parts", description="The last result by zone and by class"
    )
    result_stale: BoolProperty(
        name="Stale", description="The scene has changed since the result was made"
    )

    result_words: StringProperty(
        name="In Words", description="The last result in words, a line each"
    )
    result_missing: StringProperty(
        name="Missing", description="What was missing when it was scored, a line each"
    )
    vehicle_line: StringProperty(
        name="Vehicle in a Line", description="Its size, which way it faces, triangles and parts"
    )
    result_warnings: CollectionProperty(
        type=PE_Warning, name="Warnings", description="What the last score found odd"
    )

    variants: CollectionProperty(
        type=PE_Variant, name="Variants", description="Ideas for this vehicle, to come back to"
    )
    variant_index: IntProperty(
        name="Selected Variant", description="Row of the list that is selected", min=0
    )
    variant_key: IntProperty(
        name="Active Variant", description="Key of the variant that stands in the scene; 0: none"
    )
    variant_changed: BoolProperty(
        name="Changed", description="The scene differs from the variant that was put there"
    )

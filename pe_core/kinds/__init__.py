"""Kinds of sensors: one folder a kind, with its beams or pixels and all that counts them."""

from .by_name import MeasuredByName
from .camera import CAMERA, BrownConrady, Camera, FTheta, KannalaBrandt, Lens, Pinhole
from .ego_mask import EgoMask
from .ground_kernel import GroundKernel, GroundView, VisibleGround
from .kernels import GridKernel, Measured, SampleKernel, Stopped, Voxels
from .kind import Kind
from .lidar import LIDAR, BeamField, Lidar, RangePicture, beam_field, range_picture
from .measure import measure
from .measure_objects import ObjectsByName, measure_objects
from .object_curves import all_carried_over
from .object_kernel import ObjectKernel, ObjectView
from .perception import BLIND_RULES, PerceptionModel
from .table import KINDS, kind_named, kind_of, register, unregister
from .view_patch import ViewPatch
from .visible_ground import VisibleGroundCache

__all__ = [
    "BLIND_RULES",
    "KINDS",
    "BeamField",
    "BrownConrady",
    "Camera",
    "EgoMask",
    "FTheta",
    "GridKernel",
    "GroundKernel",
    "GroundView",
    "KannalaBrandt",
    "Kind",
    "Lens",
    "Lidar",
    "Measured",
    "MeasuredByName",
    "ObjectKernel",
    "ObjectView",
    "ObjectsByName",
    "PerceptionModel",
    "Pinhole",
    "RangePicture",
    "SampleKernel",
    "Stopped",
    "ViewPatch",
    "VisibleGround",
    "VisibleGroundCache",
    "Voxels",
    "all_carried_over",
    "beam_field",
    "kind_named",
    "kind_of",
    "measure",
    "measure_objects",
    "range_picture",
    "register",
    "unregister",
]

for _kind in (LIDAR, CAMERA):
    register(_kind)

"""Files of other programs that were read, and files of the same form that are ours: which file, of
which commit, and what our readers make of its form. ``tools/foreign_files.py`` writes the table of
docs/foreign_files.md from it. No file of a stranger is here: its structure and the names of its
fields are the same, its sensors are fewer and its numbers are others."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pe_core as pe

AXLE = pe.Reference(-1.38, 0.3)
OVRTX_LIDAR = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Z"
)

def Xform "World"
{
    # a comment as theirs
    def OmniLidar "Lidar" (
        prepend apiSchemas = ["OmniSensorGenericLidarCoreAPI"]
    )
    {
        token omni:sensor:Core:elementsCoordsType = "CARTESIAN"
        double2 omni:sensor:frameRate = (10, 1)
        double3 xformOp:translate = (0.5, 0, 2)
        float3 xformOp:rotateXYZ = (90, 0, -90)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
    }
    def "Render"
    {
        def RenderProduct "LidarProduct"
        {
            rel camera = </World/Lidar>
            rel orderedVars = [<../PointCloud>]
        }
    }
}
"""
OVRTX_CAMERA = """#usda 1.0
(
    customLayerData = {
        dictionary cameraSettings = {
            string boundCamera = "/Front"
        }
        dictionary renderSettings = {
            bool "rtx:post:histogram:enabled" = 1
        }
    }
    metersPerUnit = 0.01
    upAxis = "Y"
)

def Camera "Front" (
\thide_in_stage_window = false
)
{
\tfloat4[] clippingPlanes = []
\tfloat focalLength = 10.4775
\tfloat horizontalAperture = 20.955
\tcustom uniform vector3d omni:kit:centerOfInterest = (0, 0, -400)
\ttoken projection = "perspective"
\tfloat verticalAperture = 11.7871875
\tfloat3 xformOp:rotateYXZ = (-10, -90, 0)
\tfloat3 xformOp:scale = (1, 1, 1)
\tdouble3 xformOp:translate = (150, 140, 20)
\tuniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateYXZ", "xformOp:scale"]
}

def "Render" (
\tno_delete = true
)
{
\tdef RenderProduct "ViewportTexture0"
\t{
\t\trel camera = </Front>
\t\trel orderedVars = </Render/LdrColor>
\t\tuniform int2 resolution = (1280, 720)
\t}
\tdef RenderSettings "Settings"
\t{
\t\trel products = [
\t\t\t</Render/ViewportTexture0>,
\t\t]
\t}
}

over "OmniverseKit_Persp"
{
\tfloat focalLength = 18
}
"""
CARLA = """{"objects": [
  {"type": "sensor.pseudo.traffic_lights", "id": "traffic_lights"},
  {"type": "vehicle.audi.tt", "id": "ego_vehicle", "objects": [
    {"type": "sensor.camera.rgb", "id": "rgb_front", "image_size_x": 640, "image_size_y": 480,
     "spawn_point": {"x": 1.5, "y": 0.1, "z": 1.7, "roll": 0.0, "pitch": 10.0, "yaw": 0.0},
     "fov": 80.0, "sensor_tick": 0.05},
    {"type": "sensor.camera.rgb", "id": "rgb_view", "image_size_x": 640, "image_size_y": 480,
     "spawn_point": {"x": -4.0, "y": 0.0, "z": 3.0, "roll": 0.0, "pitch": 20.0, "yaw": 0.0},
     "fov": 90.0},
    {"type": "sensor.lidar.ray_cast", "id": "lidar", "range": 60, "channels": 16,
     "spawn_point": {"x": 0.0, "y": 0.0, "z": 2.2, "roll": 0.0, "pitch": 0.0, "yaw": 0.0},
     "points_per_second": 160000, "upper_fov": 5.0, "lower_fov": -25.0, "rotation_frequency": 10},
    {"type": "sensor.lidar.ray_cast_semantic", "id": "semantic_lidar", "range": 60, "channels": 16,
     "spawn_point": {"x": 0.0, "y": 0.0, "z": 2.2, "roll": 0.0, "pitch": 0.0, "yaw": 0.0},
     "points_per_second": 160000, "upper_fov": 5.0, "lower_fov": -25.0, "rotation_frequency": 10},
    {"type": "sensor.other.radar", "id": "radar_front", "horizontal_fov": 40.0,
     "spawn_point": {"x": 2.1, "y": 0.0, "z": 0.9, "roll": 0.0, "pitch": 0.0, "yaw": 0.0},
     "vertical_fov": 12.0, "points_per_second": 1500, "range": 90.0},
    {"type": "sensor.other.gnss", "id": "gnss", "spawn_point": {"x": 1.0, "y": 0.0, "z": 2.0}},
    {"type": "sensor.pseudo.tf", "id": "tf"},
    {"type": "actor.pseudo.control", "id": "control"}
  ]},
  {"type": "sensor.pseudo.actor_list", "id": "actor_list"}
]}
"""
SAMPLE_KIT = {
    "sensors_calibration.yaml": """base_link:
  sensor_kit_base_link: {x: 0.8, y: 0.0, z: 1.9, roll: 0.0, pitch: 0.01, yaw: 0.0}
  velodyne_rear_base_link: {x: -0.4, y: 0.0, z: 1.6, roll: 0.0, pitch: 0.7, yaw: 3.14}
""",
    "sensor_kit_calibration.yaml": """sensor_kit_base_link:
  camera0/camera_link: {x: 0.1, y: 0.5, z: -0.2, roll: 0.0, pitch: 0.3, yaw: 1.0}
  traffic_light_left_camera_link: {x: 0.1, y: 0.0, z: -0.1, roll: 0.0, pitch: 0.0, yaw: 0.0}
  velodyne_top_base_link: {x: 0.0, y: 0.0, z: 0.0, roll: 0.0, pitch: 0.0, yaw: 1.5}
  gnss_link: {x: -0.1, y: 0.0, z: -0.2, roll: 0.0, pitch: 0.0, yaw: 0.0}
  tamagawa/imu_link: {x: 0.0, y: 0.0, z: 0.0, roll: 3.14, pitch: 0.0, yaw: 3.14}
""",
}


@dataclass(frozen=True)
class ForeignForm:
    """A file of another program that was read: its `format`, `repository`, `commit` and `path`;
    `make` writes the file or folder of its form that is ours, and returns its path."""

    format: str
    repository: str
    commit: str
    path: str
    make: Callable[[Path], Path]

    def read(self, folder: Path):
        """Return what our reader makes of the form."""
        import pe_tools as pt

        return pt.import_rig(self.make(folder), self.format, AXLE)


def written(name: str, text: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = folder / name
        path.write_text(text)
        return path

    return make


def sample_kit(folder: Path) -> Path:
    for name, text in SAMPLE_KIT.items():
        (folder / name).write_text(text)
    return folder


FORMS = (
    ForeignForm(
        format="autoware",
        repository="autowarefoundation/sample_sensor_kit_launch",
        commit="3b43da7015dd65bfdcb38134aa479b6158b78bcf",
        path="sample_sensor_kit_description/config/sensor_kit_calibration.yaml",
        make=sample_kit,
    ),
    ForeignForm(
        format="carla",
        repository="carla-simulator/ros-bridge",
        commit="271d5727263b7b3bd26efe4ce1c55c5f42503f64",
        path="carla_spawn_objects/config/objects.json",
        make=written("objects.json", CARLA),
    ),
    ForeignForm(
        format="usd",
        repository="NVIDIA-Omniverse/ovrtx",
        commit="e3ebb35a6024d070fe21125f3806d6152ed3c753",
        path="examples/python/lidar/lidar_example.usda",
        make=written("lidar_example.usda", OVRTX_LIDAR),
    ),
    ForeignForm(
        format="usd",
        repository="NVIDIA-Omniverse/ovrtx",
        commit="e3ebb35a6024d070fe21125f3806d6152ed3c753",
        path="tests/data/simple_camera.usda",
        make=written("simple_camera.usda", OVRTX_CAMERA),
    ),
)

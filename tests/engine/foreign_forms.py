"""Files of other programs that were read, and files of the same form that are ours: which file, of
which commit, and what our readers make of its form. ``tools/foreign_files.py`` writes the table of
docs/foreign_files.md from it. No file of a stranger is here: its structure and the names of its
fields are the same, its sensors are fewer and its numbers are others."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
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
TYPED_KIT = {
    "sensors_calibration.yaml": """base_link:
  sensor_kit_base_link: {x: 0.8, y: 0.0, z: 1.9, roll: 0.0, pitch: 0.0, yaw: 0.0, type: units}
  front_center/radar_link:
    x: 3.4 # Design Value
    y: 0.0 # Design Value
    z: 0.6
    roll: 0.0 # Design Value
    pitch: 0.0 # Design Value
    yaw: 0.0 # Design Value
    type: radar
  hesai_front_left_base_link:
    x: 3.3 # Design Value
    y: 0.7 # Design Value
    z: 0.5
    roll: 0.0 # Design Value
    pitch: 0.0 # Design Value
    yaw: 2.4 # Design Value
    type: pandar_xt32
""",
    "sensor_kit_calibration.yaml": """# An example

sensor_kit_base_link:
  camera0/camera_link:
    x: 0.35 # Design Value
    y: 0.0 # Design Value
    z: -0.2 # Design Value
    roll: 0.0 # Design Value
    pitch: 0.0 # Design Value
    yaw: 0.0 # Design Value
    type: monocular_camera
  hesai_left_base_link:
    x: 0.0 # Design Value
    y: 0.55 # Design Value
    z: -0.3 # Design Value
    roll: 0.0 # Design Value
    pitch: 0.0 # Design Value
    yaw: 1.5707963268 # Design Value
    type: pandar_xt32
    frame_id: hesai_side_left
  tamagawa/imu_link:
    x: -0.1 # Design Value
    y: 0.0 # Design Value
    z: -0.2 # Design Value
    roll: 3.14159265359
    pitch: 0.0 # Design Value
    yaw: 3.14159265359 # Design Value
    type: imu
    frame_id: tamagawa/imu
""",
}
CARLA_LIST = """{"sensors": [
  {"type": "sensor.camera.rgb", "id": "traffic_light_camera", "image_size_x": 1280,
   "spawn_point": {"x": 0.7, "y": 0.2, "z": 1.5, "roll": 0.0, "pitch": 0.0, "yaw": 90.0},
   "image_size_y": 720, "fov": 80.0},
  {"type": "sensor.lidar.ray_cast", "id": "top", "range": 90, "channels": 32,
   "spawn_point": {"x": -0.3, "y": 0.0, "z": 1.8, "roll": 0.0, "pitch": 0.0, "yaw": 0.0},
   "points_per_second": 640000, "upper_fov": 8.0, "lower_fov": -28.0, "rotation_frequency": 20,
   "noise_stddev": 0.0},
  {"type": "sensor.other.gnss", "id": "gnss",
   "spawn_point": {"x": -1.4, "y": 0.0, "z": 0.0, "roll": 0.0, "pitch": 0.0, "yaw": 0.0}}
]}
"""
NUSCENES = {
    "sensor.json": """[
{"token": "1a", "channel": "RADAR_FRONT", "modality": "radar"},
{"token": "2b", "channel": "LIDAR_TOP", "modality": "lidar"},
{"token": "3c", "channel": "CAM_FRONT", "modality": "camera"}
]""",
    "calibrated_sensor.json": """[
{"token": "a0", "sensor_token": "1a", "translation": [3.3, 0.0, 0.5],
 "rotation": [1.0, 0.0, 0.0, 0.0], "camera_intrinsic": []},
{"token": "b0", "sensor_token": "2b", "translation": [0.95, 0.0, 1.85],
 "rotation": [0.7071067811865476, 0.0, 0.0, -0.7071067811865476], "camera_intrinsic": []},
{"token": "c0", "sensor_token": "3c", "translation": [1.68, 0.0, 1.5],
 "rotation": [0.5, -0.5, 0.5, -0.5],
 "camera_intrinsic": [[1250.0, 0.0, 810.0], [0.0, 1250.0, 480.0], [0.0, 0.0, 1.0]]},
{"token": "b1", "sensor_token": "2b", "translation": [0.95, 0.0, 1.85],
 "rotation": [0.7071067811865476, 0.0, 0.0, -0.7071067811865476], "camera_intrinsic": []}
]""",
}
KITTI = """P0: 0 0 0 0 0 0 0 0 0 0 0 0
P1: 0 0 0 0 0 0 0 0 0 0 0 0
P2: 950.5 0.0 240.25 0.0 0.0 950.5 260.5 0.0 0.0 0.0 1.0 0.0
P3: 950.5 0.0 240.25 -285.15 0.0 950.5 260.5 0.0 0.0 0.0 1.0 0.0
R0_rect: 1.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 1.0
Tr_velo_to_cam: 0.0 -1.0 0.0 0.15 0.0 0.0 -1.0 -0.1 1.0 0.0 0.0 -0.25
Tr_imu_to_velo: 0 0 0 0 0 0 0 0 0 0 0 0

"""
DRIVEWORKS = """{"rig": {"sensors": [
  {"car-mask": {"data/rle16-base64": "37UBAQAA", "resolution": [480, 302]},
   "name": "C1_front60Single",
   "nominalSensor2Rig_FLU": {"roll-pitch-yaw": [0.0, 0.0, 90.0], "t": [1.8, 0.2, 1.5]},
   "parameter": "video=C1_front60Single.h264,timestamp=C1_front60Single.h264.timestamps",
   "properties": {"Model": "ftheta",
    "bw-poly": "0.000000000000000 5.3e-4 1.2e-8 -1.4e-11 3.0e-15 ",
    "cx": "950.5", "cy": "610.25", "height": "1208", "width": "1920"},
   "protocol": "camera.virtual"}
]}}
"""
OSI = """{
 "version": {"version_major": 3, "version_minor": 8},
 "sensor_id": {"value": 0},
 "mounting_position": {"position": {"x": 0.0}, "orientation": {"yaw": 0.0}},
 "range": 150.0,
 "omit_static_information": true,
 "lidar_sensor_view_configuration": [{
  "sensor_id": {"value": 3},
  "mounting_position": {"position": {"x": 2.1, "z": 1.6}, "orientation": {"yaw": 1.5707963268}},
  "mounting_position_rmse": {"position": {"x": 0.01}},
  "field_of_view_horizontal": 2.0, "field_of_view_vertical": 0.3,
  "number_of_rays_horizontal": 80, "number_of_rays_vertical": 12,
  "max_number_of_interactions": 2, "emitter_frequency": 3.3e14
 }],
 "camera_sensor_view_configuration": [{
  "sensor_id": {"value": 4},
  "mounting_position": {"position": {"x": 3.0, "z": 1.2}},
  "field_of_view_horizontal": 1.0, "field_of_view_vertical": 0.6,
  "number_of_pixels_horizontal": 1280, "number_of_pixels_vertical": 720
 }]
}
"""
PRIUS = """<?xml version="1.0"?>
<robot xmlns:xacro="http://ros.org/wiki/xacro" name="prius">
  <gazebo reference="front_left_wheel"><mu1>0.9</mu1></gazebo>
  <link name="chassis"><inertial><mass value="1300.0"/></inertial></link>
  <link name="front_left_wheel"><inertial><mass value="11"/></inertial></link>
  <joint name="front_left_wheel_joint" type="continuous">
    <parent link="chassis"/><child link="front_left_wheel"/>
    <origin xyz="0.75 -1.4 0.3" rpy="0 0 0"/><axis xyz="1 0 0"/>
  </joint>
  <link name="front_laser_link"><inertial><mass value="1"/></inertial></link>
  <joint name="front_laser_joint" type="fixed">
    <parent link="chassis"/><child link="front_laser_link"/>
    <origin xyz="0 -2.3 0.5" rpy="0 0.05 -1.5707963268"/>
  </joint>
  <gazebo><plugin name="drive" filename="libDrive.so"><chassis>chassis</chassis></plugin></gazebo>
  <gazebo reference="front_laser_link">
    <sensor name='front_laser_sensor' type='ray'>
      <ray>
        <scan>
          <horizontal>
            <samples>640</samples><resolution>1</resolution>
            <min_angle>-2.2</min_angle><max_angle>2.2</max_angle>
          </horizontal>
          <vertical>
            <samples>1</samples><min_angle>0</min_angle><max_angle>0</max_angle>
          </vertical>
        </scan>
        <range><min>0.2</min><max>30</max><resolution>0.01</resolution></range>
      </ray>
      <plugin name='front_laser' filename='libgazebo_ros_laser.so'>
        <topicName>/prius/front_laser/scan</topicName>
      </plugin>
      <always_on>1</always_on>
    </sensor>
  </gazebo>
</robot>
"""
GPU_LIDAR = """<?xml version="1.0" ?>
<!-- a world, with models that are no vehicle -->
<sdf version="1.6">
  <world name="gpu_lidar_sensor">
    <gui fullscreen="0"><plugin filename="Scene3D" name="3D View">
      <camera_pose>-6 0 6 0 0.5 0</camera_pose></plugin></gui>
    <light type="directional" name="sun"><pose>0 0 10 0 0 0</pose></light>
    <model name="ground_plane"><static>true</static><link name="link"></link></model>
    <model name="box"><pose>0 -1 0.5 0 0 0</pose><link name="box_link"></link></model>
    <model name="camera_with_lidar">
      <pose>4 0 0.5 0 0.0 3.14</pose>
      <link name="link">
        <pose>0.1 0.05 0.6 0 0 1.5707963268</pose>
        <sensor name='gpu_lidar' type='gpu_lidar'>"
          <topic>lidar</topic>
          <updateRate>10</updateRate>
          <ray>
            <scan>
              <horizontal>
                <samples>600</samples><resolution>1</resolution>
                <min_angle>-1.4</min_angle><max_angle>1.4</max_angle>
              </horizontal>
              <vertical>
                <samples>1</samples><resolution>0.01</resolution>
                <min_angle>0</min_angle><max_angle>0</max_angle>
              </vertical>
            </scan>
            <range><min>0.08</min><max>12.0</max><resolution>0.01</resolution></range>
          </ray>
          <alwaysOn>1</alwaysOn>
        </sensor>
      </link>
      <static>true</static>
    </model>
  </world>
</sdf>
"""
SCRIPT = """#/bin/bash
source env.sh
# ros2 run tf2_ros static_transform_publisher --frame-id "link4" --child-frame-id "old_camera"
ros2 run tf2_ros static_transform_publisher --x -0.02 --y 0.05 --z 0.4 \\
  --roll 3.1415926 --pitch 0.0 --yaw 0.0 --frame-id "link5" --child-frame-id "camera"
"""
RING = {
    "egovehicle_SE3_sensor.feather": {
        "sensor_name": ["ring_front_center", "up_lidar"],
        "qw": [0.5, 1.0],
        "qx": [-0.5, 0.0],
        "qy": [0.5, 0.0],
        "qz": [-0.5, 0.0],
        "tx_m": [1.6, 1.35],
        "ty_m": [0.0, 0.0],
        "tz_m": [1.4, 1.64],
    },
    "intrinsics.feather": {
        "sensor_name": ["ring_front_center"],
        "fx_px": [1770.0],
        "fy_px": [1770.0],
        "cx_px": [775.0],
        "cy_px": [1024.0],
        "k1": [-0.26],
        "k2": [-0.21],
        "k3": [0.33],
        "height_px": [2048],
        "width_px": [1550],
    },
}


@dataclass(frozen=True)
class ForeignForm:
    """A file of another program that was read: its `format`, `repository`, `commit` and `path`;
    `make` writes the file or folder of its form that is ours, and returns its path. `placed` is
    where its origin is on the vehicle, where the format has no vehicle; `library`, what reads and
    writes the form, where that is no part of the product."""

    format: str
    repository: str
    commit: str
    path: str
    make: Callable[[Path], Path]
    placed: pe.Pose | None = None
    library: str = ""

    @property
    def can_be_read(self) -> bool:
        """Whether the library of the form is installed, if it needs one."""
        return not self.library or find_spec(self.library) is not None

    def read(self, folder: Path):
        """Return what our reader makes of the form."""
        import pe_tools as pt

        return pt.import_rig(self.make(folder), self.format, AXLE, placed=self.placed)


def written(name: str, text: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = folder / name
        path.write_text(text)
        return path

    return make


def files(texts: Mapping[str, str]) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        for name, text in texts.items():
            (folder / name).write_text(text)
        return folder

    return make


def ring_tables(folder: Path) -> Path:
    import pyarrow
    from pyarrow import feather

    for name, columns in RING.items():
        feather.write_feather(pyarrow.table(columns), folder / name)
    return folder


FORMS = (
    ForeignForm(
        format="autoware",
        repository="autowarefoundation/sample_sensor_kit_launch",
        commit="3b43da7015dd65bfdcb38134aa479b6158b78bcf",
        path="sample_sensor_kit_description/config/sensor_kit_calibration.yaml",
        make=files(SAMPLE_KIT),
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
    ForeignForm(
        format="autoware",
        repository="tier4/aip_launcher",
        commit="0d515966b4e0b721482858355443ad434824cc5b",
        path="aip_urdf_compiler/example_config/sensors_calibration.yaml",
        make=files(TYPED_KIT),
    ),
    ForeignForm(
        format="carla",
        repository="autowarefoundation/autoware_universe",
        commit="181fe6e82e5b254568a239990727f1ea5fda78b8",
        path="simulator/autoware_carla_interface/config/objects.json",
        make=written("objects.json", CARLA_LIST),
    ),
    ForeignForm(
        format="nuscenes",
        repository="harshraj32/baseline_model",
        commit="90b2afbdc92d0b19d7b9054bb2571c6cd3c92ae0",
        path="calibrated_sensor.json",
        make=files(NUSCENES),
    ),
    ForeignForm(
        format="argoverse2",
        repository="argoverse/av2-api",
        commit="4ba9cbe38ce5a9ce1b4a376f78d4eb4b65246952",
        path="src/av2/datasets/sensor/README.md",
        make=ring_tables,
        library="pyarrow",
    ),
    ForeignForm(
        format="kitti",
        repository="swdev1202/kitti_object_vis",
        commit="054bfea0e42bc6113d06f7f7bc463130a2298708",
        path="data/object/training/calib/000000.txt",
        make=written("000000.txt", KITTI),
        placed=pe.Pose((0.4, 0.0, 1.75)),
    ),
    ForeignForm(
        format="driveworks",
        repository="tdl1304/carlo",
        commit="4cec5ed3844b666c5068b4a032328001c68d2063",
        path="rig.json",
        make=written("rig.json", DRIVEWORKS),
    ),
    ForeignForm(
        format="osi",
        repository="OpenSimulationInterface/open-simulation-interface",
        commit="00eec0253d3bf675e3368d19c27d1e6b8966b4ac",
        path="osi_sensorviewconfiguration.proto",
        make=written("sensor_view_configuration.json", OSI),
    ),
    ForeignForm(
        format="urdf",
        repository="osrf/car_demo",
        commit="0da979f9e2b6d706555256bd6af3461d0767fff1",
        path="prius_description/urdf/prius.urdf",
        make=written("prius.urdf", PRIUS),
    ),
    ForeignForm(
        format="urdf",
        repository="gazebosim/gz-sim",
        commit="0524f651e1b3a7d82116722d752439ceafc1d310",
        path="examples/worlds/gpu_lidar_sensor.sdf",
        make=written("gpu_lidar_sensor.sdf", GPU_LIDAR),
    ),
    ForeignForm(
        format="ros",
        repository="iansun2/RenesasSot",
        commit="2dbeadfd603760bb4c2e404d373ed7189a98a840",
        path="workspace/arm_ws2/script/disable.start_camera_link5_tf.sh",
        make=written("start_camera_link5_tf.sh", SCRIPT),
    ),
)

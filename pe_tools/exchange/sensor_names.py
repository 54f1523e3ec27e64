"""What the name of a sensor or of its frame says: a model of the catalogue, and a kind. The tables
here are the only place that knows it; every format whose file states neither asks them."""

import re
from functools import lru_cache

from pe_core import catalog

from .portable_kinds import CAMERA, LIDAR, RADAR, ULTRASONIC

MODEL_NAMES = {
    "Velodyne VLP-16 Hi-Res": ("vlp 16 hi res", "puck hi res"),
    "Velodyne VLP-16 Puck": ("vlp 16", "puck lite", "puck", "velodyne 16"),
    "Velodyne VLP-32C Ultra Puck": ("vlp 32", "vlp 32 c", "ultra puck"),
    "Velodyne VLS-128 Alpha Prime": ("vls 128", "vls", "alpha prime", "velodyne 128"),
    "Velodyne HDL-32E": ("hdl 32", "hdl 32 e"),
    "Velodyne HDL-64E S2.1 (SZTAKI unit)": ("hdl 64 s 2", "hdl 64 e s 2"),
    "Velodyne HDL-64E S3 datasheet (1/3 deg upper block, 1/2 deg lower block)": (
        "hdl 64 s 3",
        "hdl 64 e s 3",
    ),
    "HDL-64E": ("hdl 64", "hdl 64 e"),
    "Hesai Pandar64": ("pandar 64",),
    "Pandar40": ("pandar 40",),
    "Hesai Pandar40P": ("pandar 40 p",),
    "Hesai Pandar40M": ("pandar 40 m",),
    "Hesai Pandar128E3X": ("pandar 128", "pandar 128 e 3 x"),
    "Hesai OT128 (Pandar128E4X)": ("ot 128", "pandar 128 e 4 x"),
    "Hesai PandarQT (QT64)": ("pandar qt", "pandar qt 64", "qt 64"),
    "Hesai QT128C2X": ("qt 128", "pandar qt 128", "qt 128 c 2 x"),
    "Hesai PandarXT-16": ("xt 16", "pandar xt 16"),
    "Hesai PandarXT-32 / XT32": ("xt 32", "pandar xt 32", "pandar xt"),
    "Hesai XT32M2X": ("xt 32 m", "xt 32 m 2 x", "pandar xt 32 m"),
    "Hesai AT128E2X": ("at 128", "pandar at 128", "at 128 e 2 x"),
    "Hesai ATX": ("atx",),
    "RoboSense RS-LiDAR-16": ("rs 16", "rs lidar 16", "robosense 16"),
    "RoboSense RS-LiDAR-32": ("rs 32", "rs lidar 32", "robosense 32"),
    "RoboSense RS-Bpearl": ("bpearl", "rs bpearl"),
    "RoboSense RS-Ruby (RS-128)": ("rs 128", "ruby", "rs ruby"),
    "RoboSense RS-Helios-5515 (H32F70)": ("helios", "rs helios", "helios 5515"),
    "RoboSense RS-LiDAR-M1": ("rs m 1", "rs lidar m 1", "robosense m 1"),
    "Ouster OS0-32 uniform": ("os 0 32",),
    "Ouster OS0-64 uniform": ("os 0 64",),
    "Ouster OS0-128 nominal": ("os 0 128",),
    "Ouster OS1-32 uniform": ("os 1 32",),
    "Ouster OS1-64 uniform": ("os 1 64",),
    "Ouster OS1-128 nominal": ("os 1 128",),
    "Ouster OS2-32 uniform": ("os 2 32",),
    "Ouster OS2-64 uniform": ("os 2 64",),
    "Ouster OS2-128 unit": ("os 2 128",),
    "Continental ARS408-21": ("ars 408", "ars 408 21"),
    "Continental ARS540": ("ars 540",),
    "Bosch LRR3": ("lrr 3",),
    "Delphi ESR": ("esr", "delphi esr"),
}
"""Spellings of each model's name, in parts that may be joined, or separated by any sign."""
KIND_WORDS = {
    CAMERA: "cam camera cameras fisheye rgb image infra stereo webcam zed zedm zedx realsense "
    "mynteye basler flir blackfly",
    LIDAR: "lidar laser ladar scanner velodyne velo ouster hesai pandar livox robosense rslidar "
    "hokuyo rplidar innoviz luminar cepton aeva vlp hdl",
    RADAR: "radar srr mrr lrr",
    ULTRASONIC: "ultrasonic uss",
}
"""Words of names by the kind that they say."""
_OTHER_WORDS = (
    "sonar gnss gps imu ins gyro accel odom odometry magnetometer collision",
    "antenna marker wheel tire tyre mount bracket pole mast plate bumper hitch steering knuckle",
    "axle shock hinge rotor caster motor gripper inertia microphone speaker lamp",
)
NO_SENSOR_WORDS = frozenset(word for words in _OTHER_WORDS for word in words.split())
"""Words of names of things that are neither of these kinds."""
NAME_PARTS = {
    CAMERA: ("cam", "fisheye", "rgb", "image"),
    LIDAR: (LIDAR, "laser"),
    RADAR: (RADAR,),
    ULTRASONIC: (ULTRASONIC, "uss"),
}
"""Parts of a word by the kind that they say, where no whole word says one."""
FRAME = "frame"  # What a frame of `FRAME_NAMES` is
_FRAMES = (
    "base base_link base_frame base_footprint sensor_kit sensor_kit_base_link chassis",
    "chassis_link body body_link vehicle vehicle_link ego_vehicle car map world",
)
FRAME_NAMES = frozenset(name for names in _FRAMES for name in names.split())
"""Frames of a vehicle that no sensor has."""
HUMP = re.compile("(?<=[a-z])(?=[A-Z])")  # Between the words of lidarTop


def _spelling(text: str) -> re.Pattern[str]:
    """Return a pattern of a model's name, whole words alone."""
    parts = "[^a-z0-9]*".join(map(re.escape, text.split()))
    return re.compile(f"(?<![a-z0-9]){parts}(?![a-z0-9])")


_SPELLINGS = sorted(
    ((text, _spelling(text), model) for model, texts in MODEL_NAMES.items() for text in texts),
    key=lambda row: -len(row[0]),
)  # The longest first: a VLP-16 Hi-Res is no VLP-16
_KIND_BY_WORD = {word: kind for kind, words in KIND_WORDS.items() for word in words.split()}
_KIND_BY_WORD |= {word: word for word in NO_SENSOR_WORDS}


def _plain(name: str) -> str:
    return HUMP.sub("_", name).lower()


def model_by_name(name: str, kind: str | None = None) -> str | None:
    """Return the catalogue name of the model that a name says, of a kind if that is known."""
    plain = _plain(name)
    model = next((model for _, spelling, model in _SPELLINGS if spelling.search(plain)), None)
    return model if model and kind in (None, catalog.load(model).kind) else None


@lru_cache(maxsize=16_384)  # of a file with many frames, asked for several times
def said_kind(name: str) -> str | None:
    """Return the kind of a sensor, or what else it is, as its name says; None if it says nothing.
    The last word that says something decides: a camera's IMU is an IMU."""
    plain = _plain(name)
    if plain in FRAME_NAMES:
        return FRAME
    words = re.findall("[a-z]+", plain)
    said = [_KIND_BY_WORD[word] for word in words if word in _KIND_BY_WORD]
    if said:
        return said[-1]
    if model := model_by_name(name):
        return catalog.load(model).kind
    rows = NAME_PARTS.items()
    return next((k for k, parts in rows if any(p in plain for p in parts)), None)

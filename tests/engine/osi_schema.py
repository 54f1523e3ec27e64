"""The part of OSI's schema that a configuration of sensors uses, as messages of protobuf.

Names, numbers and types of the fields of SensorViewConfiguration and its parts, from
osi_sensorviewconfiguration.proto and osi_common.proto (00eec02), all their fields but
channel formats and wavelengths. A field that is not here is none of OSI's.
"""

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

_FIELD = descriptor_pb2.FieldDescriptorProto
_SCALARS = {"double": _FIELD.TYPE_DOUBLE, "uint32": _FIELD.TYPE_UINT32}
_SCALARS |= {"uint64": _FIELD.TYPE_UINT64, "bool": _FIELD.TYPE_BOOL, "int64": _FIELD.TYPE_INT64}
_DETECTOR = "sensor_id Identifier 1; mounting_position MountingPosition 2; "
_DETECTOR += "mounting_position_rmse MountingPosition 3; "
_DETECTOR += "field_of_view_horizontal double 4; field_of_view_vertical double 5; "
_RAYS = "number_of_rays_horizontal uint32 6; number_of_rays_vertical uint32 7; "
_RAYS += "max_number_of_interactions uint32 8; emitter_frequency double 9; "
MESSAGES = {
    "InterfaceVersion": "version_major uint32 1; version_minor uint32 2; version_patch uint32 3",
    "Identifier": "value uint64 1",
    "Vector3d": "x double 1; y double 2; z double 3",
    "Orientation3d": "roll double 1; pitch double 2; yaw double 3",
    "Timestamp": "seconds int64 1; nanos uint32 2",
    "MountingPosition": "position Vector3d 1; orientation Orientation3d 2",
    "GenericSensorViewConfiguration": _DETECTOR,
    "RadarSensorViewConfiguration": _DETECTOR + _RAYS,
    "LidarSensorViewConfiguration": _DETECTOR
    + _RAYS
    + "num_of_pixels uint32 10; directions *Vector3d 11; timings *uint32 12",
    "CameraSensorViewConfiguration": _DETECTOR
    + "number_of_pixels_horizontal uint32 6; number_of_pixels_vertical uint32 7; "
    + "samples_per_pixel uint32 9; max_number_of_interactions uint32 10; orientation uint32 12",
    "UltrasonicSensorViewConfiguration": _DETECTOR,
    "SensorViewConfiguration": "version InterfaceVersion 1; sensor_id Identifier 2; "
    "mounting_position MountingPosition 3; mounting_position_rmse MountingPosition 4; "
    "field_of_view_horizontal double 5; field_of_view_vertical double 6; range double 7; "
    "update_cycle_time Timestamp 8; update_cycle_offset Timestamp 9; "
    "simulation_start_time Timestamp 10; omit_static_information bool 11; "
    "generic_sensor_view_configuration *GenericSensorViewConfiguration 1000; "
    "radar_sensor_view_configuration *RadarSensorViewConfiguration 1001; "
    "lidar_sensor_view_configuration *LidarSensorViewConfiguration 1002; "
    "camera_sensor_view_configuration *CameraSensorViewConfiguration 1003; "
    "ultrasonic_sensor_view_configuration *UltrasonicSensorViewConfiguration 1004",
}

# osi_sensordata.proto and osi_common.proto, 3.7.0: the fields that a detection area needs; JSON
# has no numbers of fields, and that of the area was not looked up.
MESSAGES |= {
    "Polygon3d": "vertex *Vector3d 1",
    "VirtualDetectionArea": "polygon *Polygon3d 1",
    "SensorData": "sensor_id Identifier 5; mounting_position MountingPosition 6; "
    "virtual_detection_area VirtualDetectionArea 29",
}


def configuration(name="SensorViewConfiguration"):
    """Return the class of a message."""
    file = descriptor_pb2.FileDescriptorProto(name="osi.proto", package="osi3", syntax="proto2")
    for key, fields in MESSAGES.items():
        message = file.message_type.add(name=key)
        for text in filter(str.strip, fields.split(";")):
            field, kind, number = text.split()
            many = _FIELD.LABEL_REPEATED if kind.startswith("*") else _FIELD.LABEL_OPTIONAL
            added = message.field.add(name=field, number=int(number), label=many)
            kind = kind.lstrip("*")
            added.type = _SCALARS.get(kind, _FIELD.TYPE_MESSAGE)
            if kind not in _SCALARS:
                added.type_name = f".osi3.{kind}"
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    found = pool.FindMessageTypeByName(f"osi3.{name}")
    return message_factory.GetMessageClass(found)

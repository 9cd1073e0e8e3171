"""Writes the MCAP files of this folder; `make.py` calls it with the signals.

The messages are serialised by rosbags, the files written by the library of Foxglove and by rosbags.
`mcap-columns.tsv` contains the numbers of `mcap-types.mcap` as mcap-ros2-support decodes them.
"""

import json
import shutil
import tempfile
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from mcap_ros2.decoder import DecoderFactory
from rosbags import rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

HERE = Path(__file__).parent
ROS_1, ROS_2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_JAZZY)
# Names of the columns of time, angle and force, and their units.
FILES = {
    "ros2-zstd.mcap": (
        ["/joints.time", "/joints.position[rudder]", "/joints.effort[rudder]"], ["s", "", ""],
    ),
    "ros2-bag.mcap": (["/angle.time", "/angle.vector.z", "/force.data"], ["s", "", ""]),
    "ros1-lz4.mcap": (
        ["/axis/wrench.time", "/axis/wrench.wrench.torque.z", "/axis/wrench.wrench.force.x"],
        ["s", "", ""],
    ),
    "json.mcap": (["/bench.time", "/bench.angle", "/bench.axis.force[0]"], ["s", "", ""]),
}
START_NS = 1_790_000_000_123_456_789
# Delay from the stamp of a message to its recording.
DELAY_NS = 1_500_000


def stamps(time):
    return [START_NS + int(round(1e9 * t)) for t in time]


def header(store, ns):
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](ns // 10**9, ns % 10**9)
    sequence = {"seq": 7} if store is ROS_1 else {}
    return types["std_msgs/msg/Header"](**sequence, stamp=stamp, frame_id="axis")


class Recording:
    """File with the definitions of its topics."""

    def __init__(self, name, store, **options):
        self.store, self.file = store, open(HERE / name, "wb")
        self.writer = Writer(self.file, **options)
        self.writer.start(profile="", library="make_mcap.py")
        self.channels = {}

    def channel(self, topic, kind):
        if topic not in self.channels:
            version = 1 if self.store is ROS_1 else 2
            definition, _ = self.store.generate_msgdef(kind, ros_version=version)
            name = kind.replace("/msg/", "/") if version == 1 else kind
            schema = self.writer.register_schema(name, f"ros{version}msg", definition.encode())
            encoding = "ros1" if version == 1 else "cdr"
            self.channels[topic] = self.writer.register_channel(topic, encoding, schema)
        return self.channels[topic]

    def write(self, topic, kind, message, ns):
        channel = self.channel(topic, kind)
        serialize = self.store.serialize_ros1 if self.store is ROS_1 else self.store.serialize_cdr
        self.writer.add_message(channel, ns, bytes(serialize(message, kind)), ns)

    def close(self):
        self.writer.finish()
        self.file.close()


def ros_2(time, angle, force):
    """Joints whose order changes, a slower topic, texts, and a topic in another encoding."""
    file = Recording("ros2-zstd.mcap", ROS_2, compression=CompressionType.ZSTD, chunk_size=4096,
                     enable_data_crcs=True)
    types = ROS_2.types
    joints = types["sensor_msgs/msg/JointState"]
    for row, ns in enumerate(stamps(time)):
        order = [0, 1] if row % 3 else [1, 0]
        pick = lambda values: np.array(values)[order]
        names = [["rudder", "elevator"][index] for index in order]
        message = joints(header(ROS_2, ns), names, pick([angle[row], 0.5]), np.array([]),
                         pick([force[row], -1.0]))
        file.write("/joints", "sensor_msgs/msg/JointState", message, ns + DELAY_NS)
        if row % 10 == 0:
            data = types["std_msgs/msg/Float64"](float(row))
            file.write("/slow", "std_msgs/msg/Float64", data, ns)
            text = types["std_msgs/msg/String"](f"row {row}")
            file.write("/note", "std_msgs/msg/String", text, ns)
    schema = file.writer.register_schema("axis.Force", "protobuf", b"\x0a\x00")
    channel = file.writer.register_channel("/other", "protobuf", schema)
    file.writer.add_message(channel, START_NS, b"\x0a\x00", START_NS)
    file.writer.add_attachment(START_NS, START_NS, "note.txt", "text/plain", b"a note")
    file.writer.add_metadata("bench", {"of": "a servo"})
    file.close()


def ros_2_bag(time, angle, force):
    """The writer of rosbags, with times of recording where a message has no header."""
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        writer = rosbag2.Writer(bag, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP)
        vector, number = "geometry_msgs/msg/Vector3Stamped", "std_msgs/msg/Float64"
        with writer:
            channels = {
                topic: writer.add_connection(topic, kind, typestore=ROS_2)
                for topic, kind in [("/angle", vector), ("/force", number)]
            }
            for row, ns in enumerate(stamps(time)):
                point = ROS_2.types["geometry_msgs/msg/Vector3"](0.0, 1.0, float(angle[row]))
                message = ROS_2.types[vector](header(ROS_2, ns), point)
                writer.write(channels["/angle"], ns + DELAY_NS, ROS_2.serialize_cdr(message, vector))
                message = ROS_2.types[number](float(force[row]))
                writer.write(channels["/force"], ns, ROS_2.serialize_cdr(message, number))
        shutil.copy(bag / "bag.mcap", HERE / "ros2-bag.mcap")


def ros_1(time, angle, force):
    """A wrench and an image, whose data are too long for columns."""
    file = Recording("ros1-lz4.mcap", ROS_1, compression=CompressionType.LZ4)
    types = ROS_1.types
    vector = types["geometry_msgs/msg/Vector3"]
    wrench, image = "geometry_msgs/msg/WrenchStamped", "sensor_msgs/msg/Image"
    for row, ns in enumerate(stamps(time)):
        content = types["geometry_msgs/msg/Wrench"](vector(float(force[row]), 0.0, -1.0),
                                                    vector(0.0, 0.0, float(angle[row])))
        file.write("/axis/wrench", wrench, types[wrench](header(ROS_1, ns), content), ns + DELAY_NS)
    for ns in stamps(time[:3]):
        picture = types[image](header(ROS_1, ns), 20, 60, "mono8", 0, 60, np.zeros(1200, np.uint8))
        file.write("/camera", image, picture, ns)
    file.close()


def as_json(time, angle, force):
    file = Recording("json.mcap", None, use_chunking=False, enable_data_crcs=True)
    schema = file.writer.register_schema("bench", "jsonschema", b'{"type": "object"}')
    channel = file.writer.register_channel("/bench", "json", schema)
    for row, ns in enumerate(stamps(time)):
        content = {
            "timestamp": {"sec": ns // 10**9, "nsec": ns % 10**9}, "angle": float(angle[row]),
            "axis": {"force": [float(force[row]), row], "is_on": row % 2 == 0}, "mode": "run",
            "gap": None if row == 5 else row,
        }
        file.writer.add_message(channel, ns + DELAY_NS, json.dumps(content).encode(), ns)
    file.close()


TYPES = """
int8 LIMIT=-5
string NAME = "a # b"
bool is_on
byte octet
char letter
int8 i8
uint8 u8
int16 i16
uint16 u16
int32 i32
uint32 u32 7
int64 i64
uint64 u64
float32 f32
float64 f64
string<=20 word
Part part
std_msgs/Empty nothing
int16[3] fixed
float64[<=4] bounded
uint8[] bytes
Part[2] parts
Part[] list
string[] texts
string[] joint_names
float32[] goal
builtin_interfaces/Duration period
builtin_interfaces/Time due
"""
PART = "bool is_on\nfloat64 value\nstring label\n"


def types():
    """Messages of every type, out of order, without a header."""
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(PART, "bench/msg/Part"))
    store.register(get_types_from_msg(TYPES.replace("Part", "bench/Part"), "bench/msg/Types"))
    made, part = store.types["bench/msg/Types"], store.types["bench/msg/Part"]
    file = Recording("mcap-types.mcap", store, compression=CompressionType.NONE)
    for row in [1, 0, 3, 2]:
        ns = START_NS + row * 10**7
        parts = [part(True, 0.5 + row, "a"), part(False, -0.25, "bc")]
        message = made(
            row % 2 == 0, 100, 65, -8 - row, 250, -1000, 60000, -100000 - row, 4 * 10**9, -(2**40), 2**50,
            0.125 * row, -1e-30, "w" * row, part(row == 3, 3.5, "xyz"), store.types["std_msgs/msg/Empty"](),
            np.array([1, -2, row], np.int16), np.arange(row, dtype=float), np.array([9, 8], np.uint8),
            parts, parts[: row % 3], ["", "é"], ["rudder", "elevator"],
            np.array([row, 2 * row], np.float32),
            store.types["builtin_interfaces/msg/Duration"](-1, 250_000_000),
            store.types["builtin_interfaces/msg/Time"]((ns + 5 * 10**8) // 10**9, (ns + 5 * 10**8) % 10**9),
        )
        file.write("/types", "bench/msg/Types", message, ns)
    file.close()
    columns = {}
    with open(HERE / "mcap-types.mcap", "rb") as data:
        reader = make_reader(data, decoder_factories=[DecoderFactory()])
        for row, (_, _, record, message) in enumerate(reader.iter_decoded_messages()):
            for name, value in numbers("/types", message, ["rudder", "elevator"]):
                columns.setdefault(name, [None] * 4)[row] = value
            columns.setdefault("/types.time", []).append((record.log_time - START_NS) / 1e9)
    lines = ("\t".join([name, *("" if v is None else repr(v) for v in values)]) for name, values in columns.items())
    (HERE / "mcap-columns.tsv").write_text("\n".join(lines) + "\n")


def numbers(path, value, names):
    """Paths and numbers of a decoded message."""
    if hasattr(value, "sec") and hasattr(value, "nanosec"):
        ns = value.sec * 10**9 + value.nanosec
        yield path, (ns - START_NS if path.endswith("due") else ns) / 1e9
    elif hasattr(value, "__slots__"):
        for field in value.__slots__:
            yield from numbers(f"{path}.{field}", getattr(value, field), names)
    elif isinstance(value, (bool, int, float)):
        yield path, float(value)
    elif isinstance(value, (list, tuple, bytes)):
        named = path.endswith(".goal")
        for index, element in enumerate(value):
            yield from numbers(f"{path}[{names[index] if named else index}]", element, names)


def write(time, angle, force):
    for make in [ros_2, ros_2_bag, ros_1, as_json]:
        make(time, angle, force)
    types()

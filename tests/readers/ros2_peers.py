"""What ROS 2 programs that are not ours make of a daemon with --ros2.

    ros2_peers.py graph PORT            zenoh-ros2-sdk: nodes, topics and types that it sees
    ros2_peers.py press PORT OUT        zenoh-ros2-sdk publishes poses and receives wrenches; rosbags
                                        decodes their bytes; one line of JSON per tick goes to OUT
    ros2_peers.py hashes                rosbags computes the hashes of our types (text on stdin)
    ros2_peers.py bag DIRECTORY         rosbags and mcap-ros2-support read a bag
"""

import json
import os
import struct
import sys
import threading
import time
from pathlib import Path

POSE = "std_msgs/Header header\ngeometry_msgs/Pose pose\n"
PARTS = """================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
"""
POSE_HASH = "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"


def path(k):
    """12 mm in, in 200 ticks, then along the surface."""
    x = 0.036 - 0.06 * min(k, 200) * 1e-3
    z = 0.045 + 0.02 * max(k - 200, 0) * 1e-3
    return x, 0.003, z


def graph(port):
    from zenoh_ros2_sdk import discovery
    from zenoh_ros2_sdk.session import ZenohSession

    ZenohSession.get_instance("127.0.0.1", port)
    topics = discovery.get_topic_names_and_types(router_ip="127.0.0.1", router_port=port)
    services = discovery.get_service_names_and_types(router_ip="127.0.0.1", router_port=port)
    print(json.dumps({"topics": topics, "services": services}, default=str), flush=True)
    leave(ZenohSession.get_instance("127.0.0.1", port))


def leave(session):
    """Closes and ends at once: threads of the SDK would keep the program."""
    session.session.close()
    os._exit(0)


def press(port, out):
    from rosbags.typesys import Stores, get_typestore
    from zenoh_ros2_sdk import ROS2Publisher
    from zenoh_ros2_sdk.session import ZenohSession

    store = get_typestore(Stores.ROS2_JAZZY)
    session = ZenohSession.get_instance("127.0.0.1", port)
    arrived, newest = threading.Event(), []

    def take(sample):
        newest.append(sample.payload.to_bytes())
        arrived.set()

    key = "0/arm/body/servo_cf/geometry_msgs::msg::dds_::WrenchStamped_/*"
    _wrenches = session.session.declare_subscriber(key, take)
    poses = ROS2Publisher(
        "/arm/measured_cp", "geometry_msgs/msg/PoseStamped", msg_definition=POSE + PARTS,
        type_hash=POSE_HASH, router_port=port,
    )
    types = session.store.types
    make = lambda name: types["geometry_msgs/msg/" + name]
    deadline = time.time() + 60
    while not poses.pub.matching_status.matching:
        assert time.time() < deadline, "nobody subscribes to poses"
        time.sleep(0.02)
    with open(out, "w") as lines:
        for k in range(1, 301):
            x, y, z = path(k)
            arrived.clear()
            poses.publish(
                header=types["std_msgs/msg/Header"](
                    stamp=types["builtin_interfaces/msg/Time"](sec=1, nanosec=k * 1_000_000), frame_id="world",
                ),
                pose=make("Pose")(
                    position=make("Point")(x=x, y=y, z=z),
                    orientation=make("Quaternion")(x=0.0, y=0.0, z=0.0, w=1.0),
                ),
            )
            assert arrived.wait(30), f"no wrench for pose {k}"
            wrench = store.deserialize_cdr(newest[-1], "geometry_msgs/msg/WrenchStamped")
            force, torque = wrench.wrench.force, wrench.wrench.torque
            numbers = [force.x, force.y, force.z, torque.x, torque.y, torque.z]
            lines.write(struct.pack(">6d", *numbers).hex() + "\n")
    assert len(newest) == 300, len(newest)
    poses.close()
    leave(session)


def hashes():
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    found = {}
    for block in json.load(sys.stdin):
        store = get_typestore(Stores.EMPTY)
        store.register(get_types_from_msg(block["text"], block["name"]))
        found[block["name"]] = store.hash_rihs01(block["name"])
    print(json.dumps(found))


def bag(directory):
    from mcap_ros2.reader import read_ros2_messages
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    by_rosbags, by_mcap = {}, {}
    with AnyReader([Path(directory)], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        for connection, stamp, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            by_rosbags.setdefault(connection.topic, []).append((stamp, numbers_of(message)))
    for file in Path(directory).glob("*.mcap"):
        for message in read_ros2_messages(str(file)):
            stamp = message.log_time_ns
            by_mcap.setdefault(message.channel.topic, []).append((stamp, numbers_of(message.ros_msg)))
    assert by_rosbags == by_mcap
    print(json.dumps({topic: [force for _, force in lines] for topic, lines in by_rosbags.items()}))


def numbers_of(message):
    if hasattr(message, "markers"):
        lines = message.markers[0].points
        return [len(lines), lines[0].x, lines[-1].z]
    if hasattr(message, "wrench"):
        return [message.wrench.force.x, message.wrench.force.y, message.wrench.force.z]
    if hasattr(message, "twist"):
        return [message.twist.linear.x, message.twist.linear.y, message.twist.linear.z]
    return [message.pose.position.x, message.pose.position.y, message.pose.position.z]


if __name__ == "__main__":
    what, arguments = sys.argv[1], sys.argv[2:]
    if what == "graph":
        graph(int(arguments[0]))
    elif what == "press":
        press(int(arguments[0]), arguments[1])
    elif what == "hashes":
        hashes()
    else:
        bag(arguments[0])

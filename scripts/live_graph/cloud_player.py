"""Plays the clouds of a simulated bag into the live graph in real time and hears all that the graph says."""
import collections
import math
import struct
import threading
import time

from offline_tools import PACKAGE, STATES

from . import Failure

NAMESPACE = "/" + PACKAGE
RESET = NAMESPACE + "/fusion_ukf/reset"
PATH, PATH_EVERY = NAMESPACE + "/path", 10  # each message holds the poses of those before it: every tenth is looked at


def finite(value):
    """Whether every number is, in a message, a list, a text of diagnostics."""
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, str):
        return value.strip().lower().lstrip("+-") not in ("nan", "inf", "infinity")
    if isinstance(value, (list, tuple)):
        return all(finite(entry) for entry in value)
    return all(finite(getattr(value, slot)) for slot in getattr(value, "__slots__", ()))


def finite_points(cloud):
    import numpy
    words = numpy.frombuffer(cloud.data, numpy.uint8).reshape(-1, cloud.point_step)
    types = {7: numpy.float32, 8: numpy.float64}  # PointField's FLOAT32, FLOAT64
    for field in cloud.fields:
        if field.datatype in types:
            kind = numpy.dtype(types[field.datatype]).newbyteorder(">" if cloud.is_bigendian else "<")
            bytes_of = words[:, field.offset:field.offset + kind.itemsize * max(1, field.count)]
            if not numpy.isfinite(numpy.ascontiguousarray(bytes_of).view(kind)).all():
                return False
    return True


def by_drive(messages):
    """{(number of the drive, stamp): message}, of messages in order of arrival: where stamps go back a new drive begins,
    which may use a stamp again."""
    answers, drive, last = {}, 0, 0
    for message in messages:
        stamp = message.header.stamp.to_nsec()
        drive += stamp < last
        last = stamp
        answers[drive, stamp] = message
    return answers


class CloudPlayer:
    """Of one graph; play() may be called for one drive after the other."""

    def __init__(self, graph):
        rospy = self._rospy = graph.join("cloud_player")
        from roslib.message import get_message_class
        from sensor_msgs.msg import PointCloud2
        from tf2_msgs.msg import TFMessage
        try:
            rospy.wait_for_service(RESET, 30.0)  # the last thing that the filter offers: all topics are there
        except rospy.ROSException as error:
            raise Failure(error)
        # A stamp farther back than max_reorder_s is a new drive, one less far is refused. The sweeps in work and waiting when a
        # new drive begins are counted by diagnostics, not by filter_state.
        self._max_reorder_s = rospy.get_param(NAMESPACE + "/fusion_ukf/max_reorder_s")
        self._lost_by_reset = 1 + rospy.get_param(NAMESPACE + "/fusion_ukf/queue_size")
        self._clouds = rospy.Publisher("/velodyne_points", PointCloud2, queue_size=100)
        self._places = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        self._lock = threading.Lock()
        self._paths = 0
        self._forget()
        for topic, type_name in rospy.get_published_topics(NAMESPACE) + [["/tf", "tf2_msgs/TFMessage"],
                                                                         ["/diagnostics", "diagnostic_msgs/DiagnosticArray"]]:
            message_class = get_message_class(type_name)  # none for the manager's own bonds
            if topic == PATH:
                rospy.Subscriber(topic, rospy.AnyMsg, self._on_path, message_class, queue_size=200)
            elif message_class is not None:
                rospy.Subscriber(topic, message_class, self._on_message, topic, queue_size=200)

    def _forget(self):
        self._heard = {}  # topic -> messages in order of arrival
        self._not_finite = {}  # topic -> how many

    def _on_message(self, message, topic):
        ok = finite_points(message) if message._type == "sensor_msgs/PointCloud2" else finite(message)
        with self._lock:
            if not ok:
                self._not_finite[topic] = self._not_finite.get(topic, 0) + 1
            if topic.startswith(NAMESPACE) and hasattr(message, "header") and not hasattr(message, "data"):
                self._heard.setdefault(topic[len(NAMESPACE) + 1:], []).append(message)

    def _on_path(self, raw, message_class):
        self._paths += 1
        if self._paths % PATH_EVERY == 1:
            self._on_message(message_class().deserialize(raw._buff), PATH)

    def _listeners(self):
        until = time.monotonic() + 30.0
        while self._clouds.get_num_connections() < 1:
            if time.monotonic() > until:
                raise Failure("the odometry does not listen to %s" % self._clouds.name)
            time.sleep(0.05)

    def play(self, path):
        """[(cloud's stamp, true time in s, true pose as 12 numbers)] in order of arrival, {topic: messages}, what was not
        finite: {topic: number of messages}. The stamps are moved to now."""
        import rosbag
        from std_srvs.srv import Trigger
        try:
            self._rospy.ServiceProxy(RESET, Trigger)()
        except self._rospy.ServiceException as error:
            raise Failure("%s: %s" % (RESET, error))
        with self._lock:
            self._forget()
        sent, untold, begin_s, shift_s = [], collections.deque(), None, None  # untold: clouds whose truth has not come yet
        with rosbag.Bag(path) as bag:
            for topic, (type_name, data, *_), recorded in bag.read_messages(raw=True):
                if topic.endswith("tf_static"):
                    self._places.publish(self._parsed(self._places, data))
                    self._listeners()
                    time.sleep(0.5)
                elif type_name == "sensor_msgs/PointCloud2":
                    if begin_s is None:
                        begin_s = time.monotonic() - recorded.to_sec()
                        shift_s = int(time.time()) - recorded.secs
                    time.sleep(max(0.0, begin_s + recorded.to_sec() - time.monotonic()))
                    data = bytearray(data)
                    seconds, nanoseconds = struct.unpack_from("<II", data, 4)  # Header: seq, stamp
                    struct.pack_into("<I", data, 4, seconds + shift_s)
                    untold.append((seconds + shift_s) * 10**9 + nanoseconds)
                    self._clouds.publish(self._parsed(self._clouds, bytes(data)))
                elif type_name == "nav_msgs/Odometry":
                    from nav_msgs.msg import Odometry
                    truth = Odometry().deserialize(data)
                    sent.append((untold.popleft(), truth.header.stamp.to_sec(), pose_row(truth.pose.pose)))
        self._settle()
        with self._lock:
            return sent, self._heard, self._not_finite

    def _settle(self):
        """Until nothing new has been heard for a second."""
        def heard():
            with self._lock:
                return len(self._heard.get("odometry", ()))
        count, until = -1, time.monotonic() + 30.0
        while heard() != count and time.monotonic() < until:
            count = heard()
            time.sleep(1.0)

    def rows_of(self, clouds, heard):
        """Of what play() gave: state, reasons and status for each cloud, as per_sweep.csv has them; the poses; what is
        wrong."""
        odometry, filtered = by_drive(heard.get("odometry", ())), by_drive(heard.get("filter_state", ()))
        told = by_drive(m for m in heard.get("time_to_failure", ()) if "STALE" not in m.reasons_text.split("|"))
        rows, poses_of, newest, lost, refused, resets = [], [], None, 0, 0, 0
        for stamp, _, _ in clouds:
            if newest is not None and 0 <= newest - stamp <= self._max_reorder_s * 1e9:
                refused += 1
                rows.append(dict(rows[-1], status="stamp_not_advancing"))
                poses_of.append(poses_of[-1])
                continue
            resets += newest is not None and stamp < newest
            newest = stamp
            pose, state, warning = (answers.get((resets, stamp)) for answers in (odometry, filtered, told))
            if pose and state and warning:
                rows.append({"state": STATES[min(warning.state, 4)], "reasons": warning.reasons_text,
                             "status": "first" if state.dt <= 0.0 else "corrected" if state.measurement_applied else "predicted"})
                poses_of.append(pose_row(pose.pose.pose))
            else:
                lost += 1
                rows.append(dict(rows[-1], status="lost") if rows else {"state": "UNKNOWN", "reasons": "", "status": "lost"})
                poses_of.append(poses_of[-1] if poses_of else list(clouds[0][2]))
        counted = sum(m.dropped_before for m in heard.get("filter_state", ()))
        if lost + refused > counted + self._lost_by_reset * resets:
            return rows, poses_of, ["%d clouds without odometry, %d refused, %d counted" % (lost, refused, counted)]
        return rows, poses_of, []

    @staticmethod
    def _parsed(publisher, data):
        return publisher.data_class().deserialize(data)


def pose_row(pose):
    """The pose as a row of KITTI's poses.txt."""
    p, q = pose.position, pose.orientation
    x, y, z, w = q.x, q.y, q.z, q.w
    return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x,
            2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y,
            2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z]

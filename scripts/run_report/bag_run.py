"""Reads a bag of a live run: topics by their types, whatever namespace they are in."""
import os
import struct

import numpy as np

from offline_tools import STATES

from . import poses
from .covariance import since
from .run import InputError, Measurement, Monitor, Run, Trajectory

PACKAGE = "fail_aware_lidar_odometry/"
ODOMETRY, FILTER_STATE, TIME_TO_FAILURE, POSE_MEASUREMENT, TRANSFORMS, CLOUD = (
    "nav_msgs/Odometry", PACKAGE + "FilterState", PACKAGE + "TimeToFailure", PACKAGE + "PoseMeasurement",
    "tf2_msgs/TFMessage", "sensor_msgs/PointCloud2")
LABELS = {"icp_point_to_point": "point-to-point ICP", "icp_point_to_plane": "point-to-plane ICP", "corner_svd": "corner SVD"}
LATENCY = "cloud to odometry"


def read(path):
    with _Bag(path) as bag:
        run = _read_sweeps(bag, path)
        run.truth = _read_truth(bag, bag.one(ODOMETRY, lambda topic: not _is_truth(topic)))
    return run


def read_truth(path, topic=None):
    """`topic`: nav_msgs/Odometry; none: the one with "truth" in its name."""
    with _Bag(path) as bag:
        found = bag.one(ODOMETRY, _is_truth if topic is None else topic.__eq__)
        if found is None:
            wanted = "with 'truth' in its name" if topic is None else topic
            raise InputError(f"{path}: no nav_msgs/Odometry topic {wanted}; there are: {', '.join(bag.topics(ODOMETRY)) or 'none'}")
        return _odometry(bag, found)


def _refuse_other_recordings(path):
    """As src/bridge/bag_sweep_source.cpp."""
    try:
        with open(path, "rb") as file:
            begin = file.read(15)
    except OSError:
        return
    for magic, extension, what in ((b"SQLite format 3", ".db3", "a ROS 2 bag (sqlite3)"),
                                   (b"\x89MCAP", ".mcap", "an MCAP file (ROS 2 bag)")):
        if begin.startswith(magic) or path.endswith(extension):
            raise InputError(f"{path} is {what}, not a ROS 1 bag; convert its folder: pip install rosbags; "
                             "rosbags-convert --src FOLDER --dst FILE.bag")


class _Bag:
    """A bag whose failures are InputErrors."""

    def __init__(self, path):
        _refuse_other_recordings(path)
        import rosbag  # only bags need it
        self._path = path
        try:
            self._bag = rosbag.Bag(path)
        except rosbag.ROSBagUnindexedException:
            raise InputError(f"{path} was not closed properly; mend it with: rosbag reindex {path}")
        except (rosbag.ROSBagException, OSError, ValueError, KeyError, struct.error) as error:
            raise InputError(f"{path} is not a readable bag: {error}")
        self._failures = (rosbag.ROSBagException, OSError, ValueError, KeyError, struct.error)
        topics = self._bag.get_type_and_topic_info()[1]
        self._types = {topic: info.msg_type for topic, info in topics.items() if info.message_count > 0}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._bag.close()

    def topics(self, type_name):
        return sorted(topic for topic, found in self._types.items() if found == type_name)

    def one(self, type_name, accept=lambda topic: True, beside=None):
        """The topic of this type: before others one in the namespace of `beside`, then one named "odometry". None: there
        is none."""
        found = [topic for topic in self.topics(type_name) if accept(topic)]
        namespace = beside.rsplit("/", 1)[0] if beside else None
        return min(found, default=None, key=lambda topic: (topic.rsplit("/", 1)[0] != namespace,
                                                           not topic.endswith("/odometry"), topic))

    def messages(self, topic):
        """(message, time of recording in s), in order of recording."""
        try:
            for _, message, recorded in self._bag.read_messages(topics=[topic]):
                yield message, recorded.to_sec()
        except self._failures as error:
            raise InputError(f"{self._path}: topic {topic} is not readable: {error}")

    def arrivals(self, topic):
        """{stamp in ns: time of recording in s}, without taking the messages apart."""
        found = {}
        try:
            for _, (_, data, _, _, _), recorded in self._bag.read_messages(topics=[topic], raw=True):
                seconds, nanoseconds = struct.unpack_from("<II", data, 4)  # Header: seq, stamp
                found.setdefault(seconds * 10**9 + nanoseconds, recorded.to_sec())
        except self._failures as error:
            raise InputError(f"{self._path}: topic {topic} is not readable: {error}")
        return found


def _is_truth(topic):
    return "truth" in topic.lower()


def _pose_of(pose):
    p, q = pose.position, pose.orientation
    return (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)


def _trajectory(rows):
    """rows: (stamp in s, position, quaternion)."""
    return Trajectory(np.array([row[0] for row in rows]),
                      poses.from_quaternion(np.array([row[1] for row in rows]), np.array([row[2] for row in rows])))


def _odometry(bag, topic):
    return _trajectory([(m.header.stamp.to_sec(),) + _pose_of(m.pose.pose) for m, _ in bag.messages(topic)])


def _read_truth(bag, odometry_topic):
    """An odometry topic with "truth" in its name; else the base frame's other parent in /tf, as kitti2bag has it."""
    topic = bag.one(ODOMETRY, _is_truth)
    if topic is not None:
        return _odometry(bag, topic)
    if odometry_topic is None:
        return None
    first, _ = next(bag.messages(odometry_topic))
    rows = []
    for topic in bag.topics(TRANSFORMS):
        if topic.endswith("static"):
            continue
        for message, _ in bag.messages(topic):
            for t in message.transforms:
                if t.child_frame_id == first.child_frame_id and t.header.frame_id != first.header.frame_id:
                    p, q = t.transform.translation, t.transform.rotation
                    rows.append((t.header.stamp.to_sec(), (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)))
    return _trajectory(rows) if rows else None


def _read_sweeps(bag, path):
    state_topic = bag.one(FILTER_STATE)
    odometry_topic = bag.one(ODOMETRY, lambda topic: not _is_truth(topic), beside=state_topic)
    if odometry_topic is None and state_topic is None:
        raise InputError(f"{path} holds neither odometry (nav_msgs/Odometry) nor filter_state ({FILTER_STATE}); "
                         "record these topics and time_to_failure, measurement/*")
    odometry = {m.header.stamp.to_nsec(): (m, recorded)
                for m, recorded in (bag.messages(odometry_topic) if odometry_topic else ())}
    states = {m.header.stamp.to_nsec(): m for m, _ in (bag.messages(state_topic) if state_topic else ())}
    stamps = sorted(states or odometry)
    if odometry and states:
        stamps = [stamp for stamp in stamps if stamp in odometry]
    if not stamps:
        raise InputError(f"{path}: odometry and filter_state have no stamp in common")
    run = Run(source=path, kind="bag of a live run", stamp_s=np.array(stamps) * 1e-9)
    run.monitor = _monitor(bag, run, state_topic or odometry_topic)
    run.facts["recorded"] = f"{os.path.getsize(path) / 1e6:.1f} MB"
    if states:
        _take_states(run, [states[stamp] for stamp in stamps])
    if odometry:
        _take_odometry(run, [odometry[stamp][0] for stamp in stamps])
        _take_latency(run, bag, stamps, [odometry[stamp][1] for stamp in stamps])
    for topic in bag.topics(POSE_MEASUREMENT):
        _take_durations(run, bag, topic, stamps)
    return run


def _monitor(bag, run, beside):
    topic = bag.one(TIME_TO_FAILURE, beside=beside)
    if topic is None:
        return None
    messages = [m for m, _ in bag.messages(topic) if m.header.stamp.to_nsec() > 0]
    if not messages:
        return None
    if not hasattr(messages[0], "t1"):
        raise InputError(f"{topic} is of an older version of TimeToFailure, without t1")

    def values(name):
        found = np.array([getattr(m, name) for m in messages], float)
        return np.where((found == -1.0) | ~np.isfinite(found), np.nan, found)

    monitor = Monitor(np.array([m.header.stamp.to_sec() for m in messages]))
    monitor.state = [STATES[m.state] if m.state < len(STATES) else str(m.state) for m in messages]
    monitor.reasons = [[reason for reason in m.reasons_text.split("|") if reason] for m in messages]
    monitor.time_to_failure_s = {"combined": values("time_to_failure"), "eta": values("time_to_failure_indicator"),
                                 "covariance": values("time_to_failure_covariance")}
    monitor.eta, monitor.sigma_yaw = np.nan_to_num(values("eta")), values("sigma_yaw")
    if hasattr(messages[0], "min_information_ahead"):
        monitor.information_ahead = values("min_information_ahead")
        monitor.information_ahead_distance_m = values("information_ahead_distance")
    last = messages[-1]
    run.horizon_s, run.eta_threshold, run.alert_limit_m = last.horizon, last.eta_threshold, last.alert_limit
    run.t1_s = last.t1.to_sec() if last.t1.to_nsec() > 0 else None
    return monitor


def _take_states(run, states):
    run.status = ["first" if m.dt <= 0 else "corrected" if m.measurement_applied else "predicted" for m in states]
    run.dropped = int(sum(m.dropped_before for m in states))
    run.fused_nis = np.array([m.fused_nis if m.has_measurement else np.nan for m in states])
    names = []
    for m in states:
        names += [name for name in m.measurement_names if name not in names]
    for name in names:
        columns = [_entry(m, name) for m in states]
        nis = np.array([nis for _, nis, _ in columns])
        run.measurements.append(Measurement(LABELS.get(name, name), np.array([weight for weight, _, _ in columns]),
                                            np.where(nis < 0, np.nan, nis), [status for _, _, status in columns]))


def _entry(message, name):
    """(weight, nis, status) of one measurement in one sweep."""
    names = list(message.measurement_names)
    if name not in names:
        return 0.0, -1.0, "absent"
    i = names.index(name)
    status = bytearray(message.measurement_status)[i]
    return message.measurement_weights[i], message.measurement_nis[i], "ok" if status == 0 else f"status {status}"


def _take_odometry(run, messages):
    run.T_odom_base = _trajectory([(0.0,) + _pose_of(m.pose.pose) for m in messages]).T
    total = np.array([m.pose.covariance for m in messages]).reshape(-1, 6, 6)
    finite = np.isfinite(run.T_odom_base).all(axis=(1, 2)) & np.isfinite(total).all(axis=(1, 2))
    if not finite.all():
        raise InputError(f"{run.source}: odometry at stamp {run.stamp_s[np.argmin(finite)]:.3f} is not finite")
    if run.t1_s is not None:
        run.covariance = since(run.T_odom_base, total, run.t1_index)


def _take_latency(run, bag, stamps, recorded):
    """Against the recording of the cloud, or of what comes at the same time (the truth); else against the stamps,
    unless these are of another day."""
    others = bag.topics(CLOUD) + [topic for topic in bag.topics(ODOMETRY) if _is_truth(topic)]
    for topic in others:
        if "/sweep/" in topic:
            continue  # the corrected sweep, which comes later
        arrived = bag.arrivals(topic)
        latency = np.array([1e3 * (at - arrived.get(stamp, np.nan)) for stamp, at in zip(stamps, recorded)])
        if np.isfinite(latency).mean() > 0.5:
            run.stage_ms[LATENCY] = latency
            return
    latency = 1e3 * (np.array(recorded) - run.stamp_s)
    if 0 <= np.median(latency) < 5e3:
        run.stage_ms["stamp to odometry"] = latency


def _take_durations(run, bag, topic, stamps):
    durations = {m.header.stamp.to_nsec(): 1e3 * m.duration for m, _ in bag.messages(topic) if m.duration > 0}
    values = np.array([durations.get(stamp, np.nan) for stamp in stamps])
    if np.isfinite(values).any():
        name = topic.rsplit("/", 1)[-1]
        run.stage_ms[LABELS.get(name, name)] = values

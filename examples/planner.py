#!/usr/bin/python3
"""A planner that obeys the time to failure (doc/planner_contract.md): what planner.cpp does, in Python.

It publishes what the vehicle must do, 20 times a second, on ~action: "drive", "slow down", "stop" (follow the pose),
"stop blind" (do not use the pose), or "own localisation" while the GPS is good. Inputs: ~gps_lost (std_msgs/Bool): true
from the loss of the GPS, when start_redundant is called, until it is back; ~gps_pose (std_msgs/Header): the header of
each good GPS pose; ~standing (std_msgs/Bool): the vehicle stands, as its wheels tell.
"""
import time

import rospy
from fail_aware_lidar_odometry.msg import TimeToFailure
from std_msgs.msg import Bool, Header, String

SILENCE_S = 0.5  # without a message: the monitor or its computer has failed
OLDEST_S = 1.0   # an older stamp is outdated
AHEAD_S = 0.1    # a stamp further in the future comes from another clock
WAIT_S = 0.5     # for t1 after the loss of the GPS
NONE, BY_THE_POSE, BLIND = 0, 1, 2

last, heard = TimeToFailure(), -1e9  # UNKNOWN until the first one comes
standing, stop, lost_since = False, NONE, None
lost_at_s, t1, pose_lost, gps_pose_at = 0.0, None, False, rospy.Time()


def is_current(stamp):
    return -AHEAD_S <= rospy.Time.now().to_sec() - stamp.to_sec() <= OLDEST_S


def on_time(message):
    global last, heard, t1, pose_lost
    last, heard = message, time.monotonic()
    if lost_since is None or message.t1.is_zero():
        return
    if t1 is None and lost_at_s - message.t1.to_sec() > OLDEST_S:
        last.state = TimeToFailure.UNKNOWN  # t1 of an earlier call: the state is not about the pose since this loss
        return
    t1 = t1 or message.t1
    # a late or new t1: the state does not include the error from the loss of the GPS to it
    pose_lost = pose_lost or message.t1 != t1 or t1.to_sec() > lost_at_s + WAIT_S


def on_wheels(message):
    global standing
    standing = message.data


def on_gps_pose(header):
    global gps_pose_at
    if lost_since is None:
        gps_pose_at = header.stamp


def on_gps(message):
    global lost_since, lost_at_s, t1, pose_lost
    if not message.data:
        lost_since, t1, pose_lost = None, None, False
    elif lost_since is None:
        pose_lost = not is_current(gps_pose_at)  # the drift from this pose to t1 is not in the state
        lost_at_s, lost_since = rospy.Time.now().to_sec(), time.monotonic()


def wanted_stop(since):
    silent = time.monotonic() - heard > SILENCE_S
    if pose_lost or silent or not is_current(last.header.stamp) or last.state == TimeToFailure.FAILED:
        return BLIND
    if last.state == TimeToFailure.UNKNOWN:
        return NONE if time.monotonic() - since < WAIT_S else BLIND
    return BY_THE_POSE if last.state == TimeToFailure.FAILING else NONE


def action():
    global stop
    since = lost_since  # on_gps may change it in another thread
    if since is None:
        stop = NONE
        return "own localisation"
    stop = wanted_stop(since) if standing else max(stop, wanted_stop(since))  # a stop that has begun ends at standstill
    if stop != NONE:
        return "stop blind" if stop == BLIND else "stop"
    return "drive" if last.state == TimeToFailure.OK else "slow down"


rospy.init_node("planner")
rospy.Subscriber("/fail_aware_lidar_odometry/time_to_failure", TimeToFailure, on_time, queue_size=1)
rospy.Subscriber("~standing", Bool, on_wheels, queue_size=1)
rospy.Subscriber("~gps_pose", Header, on_gps_pose, queue_size=1)
rospy.Subscriber("~gps_lost", Bool, on_gps, queue_size=1)
publisher = rospy.Publisher("~action", String, queue_size=1)
while not rospy.is_shutdown():
    time.sleep(0.05)
    publisher.publish(action())

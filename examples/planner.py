#!/usr/bin/python3
"""A planner that obeys the time to failure (doc/planner_contract.md): what planner.cpp does, in Python.

It publishes what the vehicle must do, 20 times a second, on ~action: "drive", "slow down", "stop" (follow the pose),
"stop blind" (do not use the pose), or "own localisation" while the GPS is good. Inputs (std_msgs/Bool): ~gps_lost: true
from the call of start_redundant until the GPS is back; ~standing: the vehicle stands, as its wheels tell.
"""
import time

import rospy
from fail_aware_lidar_odometry.msg import TimeToFailure
from std_msgs.msg import Bool, String

SILENCE_S = 0.5  # without a message: the monitor or its computer has failed
OLDEST_S = 1.0   # an older stamp is outdated
AHEAD_S = 0.1    # a stamp further in the future comes from another clock
WAIT_S = 0.5     # for t1 after the loss of the GPS
NONE, BY_THE_POSE, BLIND = 0, 1, 2

last, heard = TimeToFailure(), -1e9  # UNKNOWN until the first one comes
standing, stop, lost_since = False, NONE, None
lost_at_s, t1, pose_lost = 0.0, None, False


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


def on_gps(message):
    global lost_since, lost_at_s, t1, pose_lost
    if not message.data:
        lost_since, t1, pose_lost = None, None, False
    elif lost_since is None:
        lost_at_s, lost_since = rospy.Time.now().to_sec(), time.monotonic()


def wanted_stop(since):
    silent = time.monotonic() - heard > SILENCE_S
    age_s = rospy.Time.now().to_sec() - last.header.stamp.to_sec()
    if pose_lost or silent or not -AHEAD_S <= age_s <= OLDEST_S or last.state == TimeToFailure.FAILED:
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
rospy.Subscriber("~gps_lost", Bool, on_gps, queue_size=1)
publisher = rospy.Publisher("~action", String, queue_size=1)
while not rospy.is_shutdown():
    time.sleep(0.05)
    publisher.publish(action())

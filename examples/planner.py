#!/usr/bin/python3
"""A planner that obeys the time to failure (doc/planner_contract.md): what planner.cpp does, in Python.

It publishes what the vehicle must do, 20 times a second, on ~action: "drive", "slow down", "stop" (follow the pose) or
"stop blind" (do not use the pose). ~standing (std_msgs/Bool): the vehicle stands, as its wheels tell.
"""
import time

import rospy
from fail_aware_lidar_odometry.msg import TimeToFailure
from std_msgs.msg import Bool, String

SILENCE_S = 0.5  # without a message: the monitor or its computer has failed
OLDEST_S = 1.0   # an older stamp is outdated
AHEAD_S = 0.1    # a stamp further in the future comes from another clock
NONE, BY_THE_POSE, BLIND = 0, 1, 2

last, heard = TimeToFailure(), -1e9  # UNKNOWN until the first one comes
standing, stop = False, NONE


def on_time(message):
    global last, heard
    last, heard = message, time.monotonic()


def on_wheels(message):
    global standing
    standing = message.data


rospy.init_node("planner")
rospy.Subscriber("/fail_aware_lidar_odometry/time_to_failure", TimeToFailure, on_time, queue_size=1)
rospy.Subscriber("~standing", Bool, on_wheels, queue_size=1)
publisher = rospy.Publisher("~action", String, queue_size=1)
while not rospy.is_shutdown():
    time.sleep(0.05)
    silent = time.monotonic() - heard > SILENCE_S
    age_s = rospy.Time.now().to_sec() - last.header.stamp.to_sec()
    current = -AHEAD_S <= age_s <= OLDEST_S
    wanted = BY_THE_POSE if last.state == TimeToFailure.FAILING else NONE
    if silent or not current or last.state in (TimeToFailure.FAILED, TimeToFailure.UNKNOWN):
        wanted = BLIND
    stop = wanted if standing else max(stop, wanted)  # a stop that has begun ends at standstill
    if stop != NONE:
        action = "stop blind" if stop == BLIND else "stop"
    else:
        action = "slow down" if last.state == TimeToFailure.DEGRADED else "drive"
    publisher.publish(action)

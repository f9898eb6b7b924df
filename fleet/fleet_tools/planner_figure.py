"""What a planner that obeys the time to failure lives through, from predictions.csv (one row a second of each start t1).

The planner begins the safe stop in the first second, from LOOK_FROM_S after t1 on, in which the published time is no more
than the stop takes (speed / DECELERATION_MPS2, at least SHORTEST_STOP_S), or the state is FAILING, FAILED or UNKNOWN.
  stoppable  failures that leave the time of a stop from LOOK_FROM_S on; where a fault begins between t1 and the failure,
             from the fault's first sweep on
  in time    of these: the stop ends before the failure
  told       of the other failures: the planner stops at its first look
  used       time driven before the stop was demanded; of what a perfect predictor would have allowed ("could"): up to a
             stop before the failure, or the whole drive
Sums over starts, so the sums of recordings add up to the fleet's.
"""
import csv

from . import names

DECELERATION_MPS2, SHORTEST_STOP_S, LOOK_FROM_S, TOLERANCE_S = 2.0, 1.0, 3.0, 1e-6


def stop_time(speed_mps):
    return max(SHORTEST_STOP_S, speed_mps / DECELERATION_MPS2)


def read_starts(path):
    """{t1: rows of its seconds} in the order of the file."""
    starts = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            starts.setdefault(float(row[names.BEGIN]), []).append(
                {"since": float(row[names.SINCE_START]), "remaining": float(row[names.REMAINING]),
                 "time": float(row[names.TIME_TO_FAILURE]), "state": row[names.STATE], "speed": float(row[names.SPEED]),
                 "failed": row[names.FAILED] == "1"})
    return starts


def demands_stop(second):
    return (second["state"] in names.STATES_TO_STOP_AT or
            0 <= second["time"] <= stop_time(second["speed"]))


def judge(begin_s, seconds, fault_starts_s=()):
    """Of one start: a dictionary of counts (0 or 1) and times. `fault_starts_s`: on the clock of `begin_s`."""
    counts = {"stoppable": 0, "in_time": 0, "unstoppable": 0, "told": 0, "sound": 0, "sound_stopped": 0, "used_s": 0.0,
              "could_s": 0.0, "sound_used_s": 0.0, "sound_could_s": 0.0}
    end_s = seconds[-1]["since"] + seconds[-1]["remaining"]
    failed = seconds[0]["failed"]
    looks = [s for s in seconds if s["since"] >= LOOK_FROM_S - TOLERANCE_S and (not failed or s["remaining"] > 0)]
    stop = next((s for s in looks if demands_stop(s)), None)
    if not failed:
        if looks:
            driven_s = min(stop["since"], end_s) if stop else end_s
            counts.update(sound=1, sound_stopped=int(stop is not None), sound_used_s=driven_s, sound_could_s=end_s)
        return counts
    if not looks:
        counts.update(unstoppable=1, told=int(demands_stop(seconds[-1])))
        return counts
    # of the faults between t1 and the failure the last one, since the others did not make it fail
    faults_s = [start - begin_s for start in fault_starts_s if 0 < start - begin_s < end_s]
    warned_s = max([LOOK_FROM_S] + faults_s)
    speed_then = next((s["speed"] for s in looks if s["since"] >= warned_s - TOLERANCE_S), looks[-1]["speed"])
    if end_s < warned_s + stop_time(speed_then):
        counts.update(unstoppable=1, told=int(stop is not None and stop["since"] <= max(warned_s, looks[0]["since"]) + 1.0))
        return counts
    needed_s = stop_time(stop["speed"] if stop else looks[0]["speed"])
    could_s = max(0.0, end_s - needed_s)
    counts.update(stoppable=1, in_time=int(stop is not None and stop["since"] + needed_s <= end_s), could_s=could_s,
                  used_s=min(stop["since"], could_s) if stop else could_s)
    return counts

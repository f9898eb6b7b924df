"""Names that the package's tools give to columns, JSON members and options: the only place of the fleet that knows them."""

# predictions.csv of evaluate_fail_aware: one row a second of each start (t1)
BEGIN = "begin_s"
FAILED = "failed"
SINCE_START = "since_start_s"
REMAINING = "remaining_s"
TIME_TO_FAILURE = "combination_s"
STATE = "state"
SPEED = "speed_mps"
STATES_TO_STOP_AT = ("FAILING", "FAILED", "UNKNOWN")

# episodes.csv of evaluate_fail_aware: one row a start; BEGIN and FAILED as above
EPISODE_TIME = "time_s"
MISSED = "missed"
FALSE_ALARMS = "false_alarms"
WATCHED = "watched_s"
ALARM = "alarm_s"
UNKNOWN = "unknown_s"
LEAD = "lead_s"

# fail_aware.json of evaluate_fail_aware
COVERAGE = ("consistency", "accumulated_position")
SAMPLES = "samples"
MEAN_PER_DOF = "mean_per_dof"
WITHIN_SIGMA = "within_1_2_3_sigma"
RELIABILITY = ("times", "combination", "reliability")
BIN_FROM, BIN_TO = "from_s", "to_s"
BIN_DECIDED, BIN_FAILED_WITHIN = "decided", "failed_within"

# evaluation.json of evaluate_trajectory
PATH_LENGTH = "path_length_m"
SEGMENTS = "segments"
TRANSLATION_ERROR = "t_err_percent"
ROTATION_ERROR = "r_err_deg_per_m"
ATE_MAX = "ate_max_m"

# summary.json of offline_odometry
RUN, SCANS, DROPPED = "run", "scans", "dropped"

# faults.csv of simulate_drive
FAULT_START = "start_s"

# files
SUMMARY, PARAMETERS = "summary.json", "parameters.yaml"
TRAJECTORY_KITTI, TRAJECTORY_TUM = "trajectory_kitti.txt", "trajectory_tum.txt"
FAIL_AWARE, PREDICTIONS, EPISODES, KEPT_EPISODES = "fail_aware.json", "predictions.csv", "episodes.csv", "episodes.bin"
DRIVE_TRUTH, DRIVE_FAULTS, DRIVE_TIMES = "poses.txt", "faults.csv", "times.txt"


def inside(json, path):
    """The member of a member ..., or None."""
    for name in path:
        json = json.get(name) if isinstance(json, dict) else None
    return json

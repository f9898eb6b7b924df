"""A run as the report sees it: one entry a sweep in every array, whatever it was read from."""
from dataclasses import dataclass, field
from typing import Dict, List, Optional

import numpy as np


class InputError(Exception):
    """The run, or a file given beside it, cannot be used. The text is one line."""


class NotAvailable(Exception):
    """A picture that cannot be drawn from this run; the text says why."""


@dataclass
class Measurement:
    """One measurement of the fusion. Status: "ok" or why there is no pose."""
    label: str
    weight: np.ndarray
    nis: np.ndarray                # NaN: no measurement
    status: Optional[List[str]] = None


@dataclass
class Monitor:
    """What the planner was told. Its own clock: live it also speaks when no sweep comes."""
    stamp_s: np.ndarray
    state: Optional[List[str]] = None             # one of STATES
    reasons: Optional[List[List[str]]] = None
    time_to_failure_s: Dict[str, np.ndarray] = field(default_factory=dict)  # combined, eta, covariance; NaN: unknown
    eta: Optional[np.ndarray] = None              # rad
    sigma_yaw: Optional[np.ndarray] = None        # rad, the filter's; NaN: unknown
    information_ahead: Optional[np.ndarray] = None  # 0..1, on the weakest stretch of road in view; 1: not known
    information_ahead_distance_m: Optional[np.ndarray] = None  # to where it begins

    def first_known_s(self):
        """Stamp of the first time to failure: t1 within a sweep or two, where the run does not say it. None: never."""
        if "combined" not in self.time_to_failure_s:
            return None
        known = ~np.isnan(self.time_to_failure_s["combined"])
        if self.reasons is not None:
            known &= np.array(["STALE" not in reasons for reasons in self.reasons])
        return float(self.stamp_s[np.flatnonzero(known)[0]]) if known.any() else None


@dataclass
class Fault:
    kind: str
    start_s: float                 # on the clock of the stamps
    duration_s: float
    severity: str = ""


@dataclass
class Run:
    source: str                    # path, for the title
    kind: str                      # "offline run", "bag of a live run"
    stamp_s: np.ndarray
    status: Optional[List[str]] = None            # first, corrected, predicted
    monitor: Optional[Monitor] = None
    T_odom_base: Optional[np.ndarray] = None      # n x 4 x 4
    covariance: Optional[np.ndarray] = None       # n x 6 x 6, accumulated since t1, about the axes at t1
    measurements: List[Measurement] = field(default_factory=list)
    fused_nis: Optional[np.ndarray] = None
    stage_ms: Dict[str, np.ndarray] = field(default_factory=dict)  # stages; "total" is what a sweep took
    t1_s: Optional[float] = None                  # stamp from which the odometry served; none: never
    eta_threshold: Optional[float] = None
    horizon_s: Optional[float] = None
    alert_limit_m: float = 0.6
    comfortable_deceleration_mps2: Optional[float] = None
    failing_s: Optional[float] = None             # at any speed
    degraded_s: Optional[float] = None
    T_base_lidar: Optional[np.ndarray] = None
    first_row: int = 0                            # of the ground truth file, where the run began later
    drive_begin_s: Optional[float] = None         # stamp of the drive's first sweep; None: that of the run
    scans: int = 0                                # scan files that the run read
    drive_scans: Optional[int] = None             # scans of the whole drive
    scan_of_sweep: Optional[np.ndarray] = None    # which of them each sweep is
    dropped: Optional[int] = None                 # sweeps without a usable cloud, or lost before the odometry saw them
    facts: Dict[str, str] = field(default_factory=dict)  # further rows of the table
    truth: Optional["Trajectory"] = None          # base_link, where the run itself carries it
    why_no_truth: str = ""                        # where there is nothing to compare with
    faults: List[Fault] = field(default_factory=list)

    def __post_init__(self):
        if len(self.stamp_s) == 0:
            raise InputError(f"{self.source}: there is no sweep in it")
        if self.scan_of_sweep is None:
            self.scans, self.scan_of_sweep = len(self.stamp_s), np.arange(len(self.stamp_s))

    @property
    def time_s(self):
        """Since the first sweep."""
        return self.stamp_s - self.stamp_s[0]

    @property
    def monitor_time_s(self):
        """Of the monitor's messages, since the first sweep."""
        return self.monitor.stamp_s - self.stamp_s[0]

    @property
    def end_s(self):
        """Where the time axes end."""
        last = self.time_s[-1] if self.monitor is None else max(self.time_s[-1], self.monitor_time_s[-1])
        return max(float(last), 0.1)

    @property
    def t1_index(self):
        """The first sweep in which the odometry served; the first of all if it never did."""
        if self.t1_s is None:
            return 0
        after = np.flatnonzero(self.stamp_s >= self.t1_s - 1e-6)
        return int(after[0]) if len(after) else 0

    def state_limits_s(self):
        """Times to failure from which the state is FAILING and DEGRADED, for each sweep; None: not known. A stop from the
        sweep's speed, and two, but no less than at standstill."""
        if None in (self.failing_s, self.degraded_s, self.comfortable_deceleration_mps2) or self.T_odom_base is None:
            return None
        steps_m = np.linalg.norm(np.diff(self.T_odom_base[:, :3, 3], axis=0), axis=1)
        steps_s = np.maximum(np.diff(self.stamp_s), 1e-3)
        speed_mps = np.concatenate([[0.0], steps_m / steps_s])
        failing_s = np.maximum(self.failing_s, speed_mps / self.comfortable_deceleration_mps2)
        return failing_s, np.maximum(self.degraded_s, 2.0 * failing_s)

    @property
    def serving_from_s(self):
        """t1 since the first sweep, none if it never served."""
        return None if self.t1_s is None else float(self.time_s[self.t1_index])


@dataclass
class Trajectory:
    stamp_s: np.ndarray
    T: np.ndarray                  # n x 4 x 4

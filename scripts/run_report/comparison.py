"""The run against the truth, as evaluation/time_to_failure.hpp defines it: each in its own frame at t1."""
from dataclasses import dataclass
from typing import Optional

import numpy as np

from . import ground_truth, poses


@dataclass
class Comparison:
    index: np.ndarray              # of the run's sweeps, from t1 on, that the truth covers
    begin: int                     # sweep of t1
    truth: np.ndarray              # poses in the frame at t1, all sweeps; not covered: meaningless
    estimate: np.ndarray
    covered: np.ndarray
    time_s: np.ndarray             # since the first sweep, at `index`
    distance_m: np.ndarray         # true, since t1
    error: np.ndarray              # n x 3, m, in the frame at t1
    horizontal_m: np.ndarray
    heading_rad: np.ndarray
    failure: Optional[int]         # position in `index` of the first sweep past the alert limit

    @property
    def failure_time_s(self):
        """Since t1."""
        return None if self.failure is None else float(self.time_s[self.failure] - self.time_s[0])


def compare(run, trajectory):
    """Raises NotAvailable where there is nothing to compare."""
    truth, covered = ground_truth.matched(run, trajectory)
    begin = run.t1_index
    if not covered[begin:].any():
        raise ground_truth.NotAvailable("the ground truth does not reach beyond t1")
    begin += int(np.flatnonzero(covered[begin:])[0])
    truth, estimate = poses.relative_to(truth, begin), poses.relative_to(run.T_odom_base, begin)
    index = begin + np.flatnonzero(covered[begin:])
    error = estimate[index, :3, 3] - truth[index, :3, 3]
    horizontal = np.hypot(error[:, 0], error[:, 1])
    failed = np.flatnonzero(horizontal > run.alert_limit_m)
    return Comparison(index, begin, truth, estimate, covered, run.time_s[index], poses.distance(truth[index]), error,
                      horizontal, poses.wrapped(poses.yaw(estimate[index]) - poses.yaw(truth[index])),
                      int(failed[0]) if len(failed) else None)

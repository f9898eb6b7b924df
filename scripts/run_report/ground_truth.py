"""The true trajectory of base_link, from a file or from the run itself."""
import os
import sys

import numpy as np

from . import poses
from .run import InputError, NotAvailable, Trajectory


def find(path):
    """The file, where a sequence's folder was given."""
    if not os.path.isdir(path):
        return path
    for name in ("poses_velodyne.txt", "poses.txt", "ground_truth_tum.txt"):
        if os.path.exists(os.path.join(path, name)):
            return os.path.join(path, name)
    raise InputError(f"{path}: neither poses_velodyne.txt nor poses.txt in this folder")


def read(path, calib, run):
    """KITTI rows (12 numbers, one a scan; lidar frame, camera frame with `calib`) or TUM rows (base_link)."""
    path = find(path)
    rows = poses.read_rows(path, (12, 8))
    if rows.shape[1] == 8:
        return poses.from_tum_rows(rows)
    T = poses.from_kitti_rows(rows)
    if not calib and poses.move_like_a_camera(T):
        print(f"report: warning: {path} moves along its z axis, as KITTI's poses of the camera do: give --calib calib.txt",
              file=sys.stderr)
    if calib:
        T_camera_lidar = poses.read_lidar_to_camera(calib)
        T = np.linalg.inv(T_camera_lidar) @ T @ T_camera_lidar
    if run.T_base_lidar is not None:
        T = T @ np.linalg.inv(run.T_base_lidar)
    if len(T) not in (run.scans, run.drive_scans):
        raise InputError(f"{path} has {len(T)} poses: the ground truth needs one for each of the run's {run.scans} scans"
                         + (f", or of the drive's {run.drive_scans}" if run.drive_scans else ""))
    first = run.first_row if len(T) == run.drive_scans else 0
    return Trajectory(run.stamp_s, T[first:first + run.scans][run.scan_of_sweep])


def matched(run, trajectory):
    """The truth at the run's sweeps, and which sweeps it covers."""
    if run.T_odom_base is None:
        raise NotAvailable("the run has no trajectory (trajectory_tum.txt, or the topic odometry)")
    if trajectory is None:
        raise NotAvailable("no ground truth was given (--ground-truth)")
    if trajectory.stamp_s is run.stamp_s:  # sweep by sweep, whatever the stamps
        return trajectory.T, np.ones(len(trajectory.T), bool)
    T, covered = poses.at_stamps(trajectory, run.stamp_s)
    if not covered.any():
        raise InputError("the ground truth and the run have no time in common: stamps "
                         f"{trajectory.stamp_s[0]:.3f} to {trajectory.stamp_s[-1]:.3f} s against "
                         f"{run.stamp_s[0]:.3f} to {run.stamp_s[-1]:.3f} s")
    return T, covered

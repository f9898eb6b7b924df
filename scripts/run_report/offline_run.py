"""Reads what offline_odometry wrote into its output folder."""
import csv
import os

import numpy as np

from . import poses
from .run import InputError, Measurement, Monitor, Run
from .run_folder import read_summary

MEASUREMENTS = [("icp_point_to_point", "point-to-point ICP"), ("icp_point_to_plane", "point-to-plane ICP"),
                ("corner_svd", "corner SVD")]
STAGES = [("correction", "deskew"), *MEASUREMENTS, ("fusion", "fusion, UKF"), ("reference", "map update")]


class _Table:
    """per_sweep.csv, without the rows of sweeps that have no pose."""

    def __init__(self, path):
        self.path = path
        try:
            with open(path, newline="", encoding="utf-8-sig", errors="replace") as file:
                rows = list(csv.reader(file))
        except OSError as error:
            raise InputError(f"cannot read {path}: {error.strerror}")
        except csv.Error as error:
            raise InputError(f"{path}: {error}")
        if len(rows) < 2:
            raise InputError(f"{path}: no sweep in it")
        self.names = rows[0]
        for number, row in enumerate(rows[1:], 2):
            if len(row) != len(self.names):
                raise InputError(f"{path}: line {number} has {len(row)} cells, the header {len(self.names)}")
        self.rows = rows[1:]
        refused = [status in ("stamp_not_advancing", "not_started") for status in self.text("status") or []]
        self.kept = np.array([not bad for bad in refused] if refused else [True] * len(self.rows))
        self.rows = [row for row, keep in zip(self.rows, self.kept) if keep]

    def text(self, name):
        """None: there is no such column."""
        if name not in self.names:
            return None
        index = self.names.index(name)
        return [row[index] for row in self.rows]

    def numbers(self, name, unknown=None):
        """None: there is no such column. `unknown`: the value that means it, given as NaN; not finite likewise."""
        cells = self.text(name)
        if cells is None:
            return None
        try:
            values = np.array([float(cell) for cell in cells])
        except ValueError:
            raise InputError(f"{self.path}: column {name} does not hold numbers only")
        values[~np.isfinite(values)] = np.nan
        if unknown is not None:
            values[values == unknown] = np.nan
        return values


def _covariance(table):
    """Of x, y, z and yaw; None if the run has only an older per_sweep.csv."""
    columns = {name: table.numbers("cov_" + name) for name in ("xx", "xy", "yy", "zz", "yaw")}
    if any(column is None for column in columns.values()):
        return None
    C = np.zeros((len(columns["xx"]), 6, 6))
    C[:, 0, 0], C[:, 1, 1], C[:, 2, 2], C[:, 5, 5] = columns["xx"], columns["yy"], columns["zz"], columns["yaw"]
    C[:, 0, 1] = C[:, 1, 0] = columns["xy"]
    return np.nan_to_num(C)


def _monitor(table, stamp_s):
    reasons = table.text("reasons")
    monitor = Monitor(stamp_s, table.text("state"),
                      None if reasons is None else [[r for r in cell.split("|") if r] for cell in reasons])
    for name, column in (("combined", "time_to_failure"), ("eta", "time_to_failure_indicator"),
                         ("covariance", "time_to_failure_covariance")):
        values = table.numbers(column, unknown=-1.0)
        if values is not None:
            monitor.time_to_failure_s[name] = values
    monitor.eta = table.numbers("eta")
    monitor.sigma_yaw = table.numbers("sigma_yaw", unknown=-1.0)
    monitor.information_ahead = table.numbers("min_information_ahead")
    monitor.information_ahead_distance_m = table.numbers("information_ahead_distance_m")
    return monitor


def _measurements(table):
    found = []
    for key, label in MEASUREMENTS:
        weight = table.numbers("weight_" + key)
        if weight is None:
            continue
        nis = table.numbers("nis_" + key, unknown=-1.0)
        nis = np.full(len(weight), np.nan) if nis is None else nis
        found.append(Measurement(label, weight, nis, table.text(key + "_status")))
    return found


def _trajectory(folder, table):
    """base_link at each kept sweep, from trajectory_tum.txt."""
    path = os.path.join(folder, "trajectory_tum.txt")
    if not os.path.exists(path):
        return None
    trajectory = poses.from_tum_rows(poses.read_rows(path, (8,)))
    if len(trajectory.T) != table.kept.sum():
        raise InputError(f"{path} has {len(trajectory.T)} rows, {table.path} {table.kept.sum()} accepted sweeps")
    return trajectory.T


def read(folder):
    summary = read_summary(folder)
    table = _Table(os.path.join(folder, "per_sweep.csv"))
    stamp_s = table.numbers("stamp")
    if stamp_s is None or np.isnan(stamp_s).any():
        raise InputError(f"{table.path}: no column stamp, or a stamp that is not finite")
    described = summary["run"]
    run = Run(source=folder, kind="offline run", stamp_s=stamp_s, scans=len(table.kept),
              scan_of_sweep=np.flatnonzero(table.kept))
    run.status = table.text("status")
    run.monitor = _monitor(table, stamp_s)
    run.T_odom_base = _trajectory(folder, table)
    run.covariance = _covariance(table)
    run.measurements = _measurements(table)
    run.fused_nis = table.numbers("nis_fused", unknown=-1.0)
    for key, label in STAGES + [("total", "total")]:
        values = table.numbers("ms_" + key)
        if values is not None:
            run.stage_ms[label] = values
    run.drive_begin_s = described.get("drive_begin_stamp_s")
    _describe(run, described, table)
    run.dropped = summary.get("dropped")
    run.facts = {label: str(summary[key]) for label, key in (("profile", "profile"), ("threads", "threads"))
                 if key in summary}
    if "max_rss_mb" in summary:
        run.facts["memory"] = f"{summary['max_rss_mb']:.0f} MB at most"
    return run


def _describe(run, described, table):
    try:
        run.t1_s = described.get("t1_stamp_s", run.monitor.first_known_s())
        run.eta_threshold = described.get("eta_threshold_rad")
        run.horizon_s = described.get("horizon_s")
        run.alert_limit_m = float(described.get("alert_limit_m", run.alert_limit_m))
        run.failing_s, run.degraded_s = described.get("failing_s"), described.get("degraded_s")
        run.comfortable_deceleration_mps2 = described.get("comfortable_deceleration_mps2")
        if "lidar_in_base" in described:
            run.T_base_lidar = poses.from_xyz_rpy([float(value) for value in described["lidar_in_base"]])
        run.first_row = int(described.get("first", 0))
        run.drive_scans = int(described.get("drive_scans", run.scans))
    except (TypeError, ValueError):
        raise InputError(f"{os.path.join(os.path.dirname(table.path), 'summary.json')}: 'run' is not as "
                         "offline_odometry writes it")

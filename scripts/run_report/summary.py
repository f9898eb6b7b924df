"""The table at the top of the page: (name, value) rows."""
import numpy as np

from . import kitti_metric, poses


def rows(run, comparison):
    table = [("run", f"{run.kind}: {run.source}")]
    table += [(label, value) for label, value in run.facts.items()]
    table += _drive(run, comparison)
    table += _sweeps(run)
    table += _fail_aware(run, comparison)
    table += _accuracy(run, comparison)
    return table


def _drive(run, comparison):
    table = [("duration", f"{run.time_s[-1]:.1f} s")]
    if run.T_odom_base is not None:
        text = f"{poses.distance(run.T_odom_base)[-1]:.0f} m by the odometry"
        if comparison is not None and comparison.covered.all():
            text += f", {poses.distance(comparison.truth)[-1]:.0f} m in truth"
        table.append(("distance", text))
    return table


def _sweeps(run):
    parts = [f"{len(run.stamp_s)}"]
    if run.dropped is not None:
        parts.append(f"{run.dropped} dropped")
    if run.status is not None:
        parts.append(f"{run.status.count('predicted')} with a prediction only")
    table = [("sweeps", ", ".join(parts))]
    whole = run.stage_ms.get("total")
    whole = run.stage_ms.get("cloud to odometry") if whole is None else whole
    if whole is not None and np.isfinite(whole).any():
        known = whole[np.isfinite(whole)]
        p50, p95, p99 = np.percentile(known, [50, 95, 99])
        name = "time of a sweep" if "total" in run.stage_ms else "cloud to odometry"
        table.append((name, f"mean {known.mean():.1f} ms, median {p50:.1f}, 95 % {p95:.1f}, 99 % {p99:.1f}"))
    return table


def first_alarm(run):
    """The monitor's first message from t1 on that says FAILING or FAILED; None: there was none."""
    if run.monitor is None or run.monitor.state is None or run.t1_s is None:
        return None
    for i in np.flatnonzero(run.monitor_time_s >= run.serving_from_s - 1e-6):
        if run.monitor.state[i] in ("FAILING", "FAILED"):
            return int(i)
    return None


def _alarm_text(run, alarm):
    monitor = run.monitor
    text = f"{monitor.state[alarm]} {run.monitor_time_s[alarm] - run.serving_from_s:.1f} s after t1"
    left = monitor.time_to_failure_s.get("combined")
    if left is not None and np.isfinite(left[alarm]):
        text += f", time to failure {left[alarm]:.1f} s"
    if monitor.reasons and monitor.reasons[alarm]:
        text += "; reasons " + ", ".join(monitor.reasons[alarm])
    return text


def _final_state(run):
    """At the last sweep; live the monitor goes on speaking."""
    at_last = int(np.flatnonzero(run.monitor_time_s <= run.time_s[-1] + 1e-6)[-1:].max(initial=0))
    text = run.monitor.state[at_last]
    if at_last + 1 < len(run.monitor.state):
        text += f", and {run.monitor.state[-1]} {run.monitor_time_s[-1] - run.time_s[-1]:.1f} s after the last sweep"
    return text


def _fail_aware(run, comparison):
    table, alarm = [], first_alarm(run)
    table.append(("t1: the odometry serves from", "never" if run.t1_s is None else f"{run.serving_from_s:.1f} s on"))
    if run.monitor is not None and run.monitor.state is not None:
        if run.t1_s is not None:
            table.append(("first alarm", "none" if alarm is None else _alarm_text(run, alarm)))
        table.append(("final state", _final_state(run)))
    if comparison is not None:
        passed = comparison.failure_time_s
        table.append((f"error passes {run.alert_limit_m:g} m", "not before the end" if passed is None
                      else f"{passed:.1f} s after " + ("t1" if run.t1_s is not None else "the first sweep")))
        if passed is not None and run.t1_s is not None:
            table.append(("warning", _warning_text(run, comparison, alarm)))
    return table


def _warning_text(run, comparison, alarm):
    if alarm is None:
        return "none: missed"
    lead_s = comparison.time_s[comparison.failure] - run.monitor_time_s[alarm]
    if abs(lead_s) < 0.05:
        return "at the same sweep"
    return f"{lead_s:.1f} s ahead" if lead_s > 0 else f"{-lead_s:.1f} s late"


def _accuracy(run, comparison):
    if comparison is None:
        return [("accuracy", f"not known: {run.why_no_truth}")]
    since = "t1" if run.t1_s is not None else "the first sweep"
    table = [(f"error at the end, since {since}",
              f"{comparison.horizontal_m[-1]:.2f} m horizontal, {comparison.error[-1, 2]:+.2f} m vertical, "
              f"{np.degrees(comparison.heading_rad[-1]):+.2f} deg heading, over {comparison.distance_m[-1]:.0f} m")]
    T_base_lidar = np.eye(4) if run.T_base_lidar is None else run.T_base_lidar
    metric, why = kitti_metric.evaluate(comparison.truth[comparison.covered] @ T_base_lidar,
                                        comparison.estimate[comparison.covered] @ T_base_lidar)
    if metric is None:
        table.append(("KITTI's metric", f"not known: {why}"))
    else:
        table.append(("KITTI's metric, whole run",
                      f"{metric['t_err_percent']:.2f} %, {metric['r_err_deg_per_m']:.4f} deg/m"))
    return table

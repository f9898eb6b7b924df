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
    """The first sweep from t1 on that is FAILING or FAILED; None: there was none."""
    if run.state is None or run.t1_s is None:
        return None
    alarms = [i for i in range(run.t1_index, len(run.state)) if run.state[i] in ("FAILING", "FAILED")]
    return alarms[0] if alarms else None


def _alarm_text(run, alarm):
    text = f"{run.state[alarm]} {run.time_s[alarm] - run.serving_from_s:.1f} s after t1"
    left = run.time_to_failure_s.get("combined")
    if left is not None and np.isfinite(left[alarm]):
        text += f", time to failure {left[alarm]:.1f} s"
    if run.reasons and run.reasons[alarm]:
        text += "; reasons " + ", ".join(run.reasons[alarm])
    return text


def _fail_aware(run, comparison):
    table = []
    if run.serving_from_s is None:
        table.append(("t1", "the odometry never served as the localisation"))
    else:
        table.append(("t1: the odometry serves from", f"{run.serving_from_s:.1f} s on"))
    alarm = first_alarm(run)
    if run.state is not None and run.t1_s is not None:
        table.append(("first alarm", "none" if alarm is None else _alarm_text(run, alarm)))
    if run.state is not None:
        table.append(("final state", run.state[-1]))
    if comparison is not None:
        passed = comparison.failure_time_s
        table.append((f"error passes {run.alert_limit_m:g} m", "not before the end" if passed is None
                      else f"{passed:.1f} s after " + ("t1" if run.t1_s is not None else "the first sweep")))
        if passed is not None and alarm is not None:
            lead = comparison.time_s[comparison.failure] - run.time_s[alarm]
            table.append(("warning", f"{lead:.1f} s ahead" if lead > 0 else
                          "at the same sweep" if lead == 0 else f"{-lead:.1f} s late"))
    return table


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

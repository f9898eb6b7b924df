"""What the sweeps saw of the road ahead: how weak its weakest stretch is, and how far away it begins."""
import numpy as np

from . import style
from .run import NotAvailable


def draw(run, comparison):
    monitor = run.monitor
    if monitor is None or monitor.information_ahead is None:
        raise NotAvailable("the run says nothing of the road ahead (min_information_ahead)")
    known = monitor.information_ahead < 1.0
    if not known.any():
        raise NotAvailable("no sweep saw enough of the road ahead")
    figure, ((upper,), (lower,)) = style.figure(2, height_in=5.0)
    for axes in (upper, lower):
        style.shade_faults(axes, run.faults, run.stamp_s[0], label=axes is upper)
        style.mark_t1(axes, run.serving_from_s, "t1" if axes is upper else None)
    ratio = np.where(known, np.maximum(monitor.information_ahead, 1e-4), np.nan)
    weak = np.array(["WEAK_ROAD_AHEAD" in reasons for reasons in monitor.reasons or [[]] * len(known)])
    upper.semilogy(run.monitor_time_s, ratio, color=style.BLUE, linewidth=1.2, label="ratio on the weakest stretch")
    upper.set(ylabel="information along the road", ylim=(8e-5, 1))
    style.legend(upper)
    distance_m = np.where(known, monitor.information_ahead_distance_m, np.nan)
    lower.plot(run.monitor_time_s, np.where(weak, np.nan, distance_m), ".", markersize=3, color=style.GREY,
               label="to where it begins")
    lower.plot(run.monitor_time_s, np.where(weak, distance_m, np.nan), ".", markersize=4, color=style.ORANGE,
               label="the same, where it is weak (WEAK_ROAD_AHEAD)")
    lower.set(ylabel="distance (m)", xlabel="time since the first sweep (s)", xlim=(0, run.end_s))
    style.legend(lower)
    figure.align_ylabels()
    return figure

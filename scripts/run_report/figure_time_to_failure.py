"""What the odometry said of its time to failure, against the time that was really left."""
import numpy as np

from . import style
from .run import NotAvailable

SERIES = (("covariance", "from the covariance", style.GREEN, "-", 1.6), ("eta", "from eta", style.ORANGE, "-", 1.6),
          ("combined", "combined: for the planner", style.BLUE, (0, (4, 1.5)), 2.0))


def draw(run, comparison):
    predicted = run.monitor.time_to_failure_s if run.monitor is not None else {}
    if not any(np.isfinite(values).any() for values in predicted.values()):
        raise NotAvailable("the time to failure was unknown throughout" if predicted
                           else "the run carries no time to failure")
    figure, ((axes,),) = style.figure(height_in=4.2)
    style.shade_faults(axes, run.faults, run.stamp_s[0])
    style.mark_t1(axes, run.serving_from_s, "t1")
    if comparison is not None and run.t1_s is not None:
        _truth(axes, run, comparison)
    for key, label, colour, line, width in SERIES:
        if key in predicted:
            axes.plot(run.monitor_time_s, predicted[key], color=colour, linestyle=line, linewidth=width, label=label)
    limits = run.state_limits_s()
    for values, label in zip(limits or (), ("FAILING below", "DEGRADED below")):
        axes.plot(run.time_s, values, color=style.GREY, linewidth=0.8)
        axes.annotate(label, (1.005, values[-1]), xycoords=("axes fraction", "data"), fontsize=8.5, ha="left",
                      va="center", color=style.GREY)
    top = run.horizon_s or max(np.nanmax(values) for values in predicted.values())
    axes.set(xlabel="time since the first sweep (s)", ylabel="time to failure (s)", ylim=(0, 1.04 * top),
             xlim=(0, run.end_s))
    style.legend(axes, columns=7)
    return figure


def _truth(axes, run, comparison):
    """Right-censored at the end of the run where it did not fail."""
    failed = comparison.failure is not None
    end = comparison.time_s[comparison.failure] if failed else comparison.time_s[-1]
    label = (f"truth: time to {run.alert_limit_m:g} m" if failed
             else "truth: more than this")
    begin = comparison.time_s[0]
    axes.plot([begin, end, max(end, run.time_s[-1]) if failed else end], [end - begin, 0, 0], color=style.BLACK,
              linewidth=2.6, alpha=0.6, linestyle="-" if failed else (0, (1, 1)), label=label)

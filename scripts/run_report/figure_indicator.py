"""The article's figure of the fail-aware process: sigma_psi, eta with threshold and predictions, horizontal error."""
import numpy as np

from . import style
from .run import NotAvailable

LINES = 8


def draw(run, comparison):
    monitor = run.monitor
    if monitor is None or monitor.sigma_yaw is None or monitor.eta is None:
        raise NotAvailable("the run carries no sigma_yaw or no eta (time_to_failure)")
    panels = 2 if comparison is None else 3
    figure, axes = style.figure(panels, height_in=2.6 * panels + 0.4)
    axes = axes[:, 0]
    time_s = run.monitor_time_s
    for i, panel in enumerate(axes):
        style.shade_faults(panel, run.faults, run.stamp_s[0], label=i == 0)
        style.mark_t1(panel, run.serving_from_s, "t1: the odometry serves" if i == 0 else None)
    axes[0].plot(time_s, 1e3 * monitor.sigma_yaw, color=style.BLUE, label=r"$\sigma_\psi$ of the filter")
    axes[0].set(ylabel=r"(a)  $\sigma_\psi$ (mrad)")
    _scale_sigma(axes[0], 1e3 * monitor.sigma_yaw)
    style.legend(axes[0])
    _eta(axes[1], run)
    if comparison is not None:
        _error(axes[2], run, comparison)
    axes[-1].set(xlabel="time since the first sweep (s)", xlim=(0, run.end_s))
    figure.align_ylabels()
    return figure


def _short(value):
    """Two digits at least, never with an exponent."""
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}"


def _scale_sigma(axes, sigma):
    """The start-up is far above the rest, and would hide it."""
    finite = sigma[np.isfinite(sigma)]
    if not len(finite):
        return
    top = np.percentile(finite, 98) * 1.4
    axes.set_ylim(0, top if top > 0 else 1)
    if finite.max() > top:
        axes.set_title(f"highest: {_short(finite.max())} mrad, off the scale", loc="right", fontsize=9, color=style.GREY)


def _eta(axes, run):
    eta = 1e3 * run.monitor.eta
    axes.plot(run.monitor_time_s, eta, color=style.BLUE, linewidth=2, zorder=4, label=r"$\eta$")
    axes.set_ylabel(r"(b)  $\eta$ (mrad)")
    if run.eta_threshold is None:
        axes.set_title("the run does not say its threshold", loc="right", fontsize=9, color=style.GREY)
        style.legend(axes)
        return
    threshold = 1e3 * run.eta_threshold
    axes.axhline(threshold, color=style.LIMIT, linestyle="--", zorder=3, label=f"threshold {threshold:g} mrad")
    _prediction_lines(axes, run, threshold)
    axes.set_ylim(0, min(max(1.1 * np.nanmax(eta), 1.15 * threshold), 2.0 * threshold))
    passed = np.flatnonzero(eta >= threshold)
    if len(passed):
        axes.set_title(f"passed at {run.monitor_time_s[passed[0]]:.1f} s; {_short(np.nanmax(eta))} mrad at the end", loc="right",
                       fontsize=9, color=style.GREY)
    style.legend(axes)


def _prediction_lines(axes, run, threshold):
    """From eta now to the threshold at the predicted time."""
    monitor, time_s = run.monitor, run.monitor_time_s
    remaining = monitor.time_to_failure_s.get("eta")
    if remaining is None:
        return
    usable = np.flatnonzero((remaining > 0) & (monitor.eta < run.eta_threshold))
    if run.horizon_s:
        usable = usable[remaining[usable] < run.horizon_s]
    if not len(usable):
        return
    for n, i in enumerate(np.unique(usable[np.linspace(0, len(usable) - 1, LINES).astype(int)])):
        axes.plot([time_s[i], time_s[i] + remaining[i]], [1e3 * monitor.eta[i], threshold], color=style.GREEN,
                  linewidth=1.1, label="predicted way to the threshold" if n == 0 else None)


def _error(axes, run, comparison):
    axes.plot(comparison.time_s, comparison.horizontal_m, color=style.BLUE, label="horizontal error since t1")
    axes.axhline(run.alert_limit_m, color=style.LIMIT, linestyle="--", label=f"alert limit {run.alert_limit_m:g} m")
    if comparison.failure is not None:
        axes.axvline(comparison.time_s[comparison.failure], color=style.BLACK, linewidth=1.2,
                     label=f"passes {run.alert_limit_m:g} m")
    top = comparison.horizontal_m.max()
    shown = min(max(1.1 * top, 1.3 * run.alert_limit_m), 4 * run.alert_limit_m)
    if top > shown:
        axes.set_title(f"highest: {top:.1f} m, off the scale", loc="right", fontsize=9, color=style.GREY)
    axes.set(ylabel="(c)  error (m)", ylim=(0, shown))
    style.legend(axes)

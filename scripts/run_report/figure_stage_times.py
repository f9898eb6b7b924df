"""Where the time of a sweep goes: over the run, and as percentiles of each stage."""
import numpy as np

from . import style
from .run import NotAvailable


def draw(run, comparison):
    stages = {label: values for label, values in run.stage_ms.items() if np.isfinite(values).any()}
    if not stages:
        raise NotAvailable("the run carries no times of its stages")
    figure = style.plt.figure(figsize=(style.WIDTH_IN, 1.6 + 3.0 + 0.36 * len(stages)))
    top, bottom = figure.subplots(2, 1, gridspec_kw={"height_ratios": [3.0, 0.6 + 0.36 * len(stages)]})
    period_ms = 1e3 * float(np.median(np.diff(run.stamp_s))) if len(run.stamp_s) > 1 else None
    whole = stages.get("total")
    if whole is not None:
        top.plot(run.time_s, whole, color=style.BLUE, linewidth=0.8, label="total")
    else:
        for colour, (label, values) in zip(style.SERIES, stages.items()):
            top.plot(run.time_s, values, color=colour, linewidth=0.8, label=label)
    highest = max(np.nanmax(values) for values in stages.values())
    if period_ms and highest > 0.3 * period_ms:
        top.axhline(period_ms, color=style.LIMIT, linestyle="--", label=f"time between sweeps, {period_ms:.0f} ms")
    top.set(xlabel="time since the first sweep (s)", ylabel="time (ms)", xlim=(0, run.end_s))
    top.set_ylim(bottom=0)
    style.legend(top)
    _percentiles(bottom, stages)
    return figure


def _percentiles(axes, stages):
    for i, (label, values) in enumerate(stages.items()):
        known = values[np.isfinite(values)]
        p50, p95, p99 = np.percentile(known, [50, 95, 99])
        axes.barh(-i, p50, height=0.62, color=style.BLUE, label="median" if i == 0 else None)
        axes.barh(-i, p95 - p50, left=p50, height=0.62, color=style.SKY, label="to 95 %" if i == 0 else None)
        axes.barh(-i, p99 - p95, left=p95, height=0.62, color=style.LIGHT, label="to 99 %" if i == 0 else None)
        axes.annotate(f"  {p50:.3g} / {p95:.3g} / {p99:.3g} ms", (p99, -i), va="center", fontsize=9)
    axes.set_yticks([-i for i in range(len(stages))])
    axes.set_yticklabels(list(stages))
    axes.set_xlabel("time (ms): median / 95 % / 99 % of the sweeps")
    axes.set_xlim(0, 1.22 * max(np.nanpercentile(values, 99) for values in stages.values()) + 1e-3)
    axes.grid(axis="y", visible=False)
    style.legend(axes)

"""What the fusion made of each measurement: weights with gated and absent sweeps; normalised innovations squared."""
import numpy as np

from . import style
from .run import NotAvailable

USED, GATED, ABSENT = "used", "gated out", "no pose"
USE_COLOURS = {USED: style.GREEN, GATED: style.ORANGE, ABSENT: style.LIGHT}
CHI2_6_LOW, CHI2_6_HIGH = 1.237, 14.449  # 2.5 % and 97.5 % of 6 degrees of freedom


def use_of(measurement):
    """used, gated out or no pose, a sweep each."""
    uses = np.where(measurement.weight > 0, USED, GATED).astype(object)
    if measurement.status is not None:
        uses[np.array([status != "ok" for status in measurement.status]) & (measurement.weight <= 0)] = ABSENT
    else:
        uses[~np.isfinite(measurement.nis) & (measurement.weight <= 0)] = ABSENT
    return uses


def draw_weights(run, comparison):
    if not run.measurements:
        raise NotAvailable("the run carries no weights (filter_state)")
    figure, axes = style.figure(len(run.measurements), height_in=1.75 * len(run.measurements) + 0.9)
    for panel, measurement in zip(axes[:, 0], run.measurements):
        uses = use_of(measurement)
        style.shade_faults(panel, run.faults, run.stamp_s[0])
        panel.plot(*style.with_gaps(run.time_s, np.where(uses == USED, measurement.weight, np.nan)), color=style.BLUE,
                   linewidth=1.0)
        for use, colour in USE_COLOURS.items():
            spans = [span for found, span in style.spans(run.time_s, uses, gaps=True) if found == use]
            style.bars(panel, spans, -0.16, 0.11, colour)
        shares = ", ".join(f"{use} {100 * np.mean(uses == use):.0f} %" for use in USE_COLOURS)
        panel.set_title(f"{measurement.label}: {shares}", loc="right", fontsize=9.5)
        panel.set(ylabel="weight", ylim=(-0.18, 1.05), yticks=[0, 0.5, 1])
    axes[-1, 0].set(xlabel="time since the first sweep (s)", xlim=(0, run.end_s))
    handles = [style.patch(colour, f"strip: {use}") for use, colour in USE_COLOURS.items()]
    style.legend(axes[0, 0], handles + axes[0, 0].get_legend_handles_labels()[0], columns=4)
    return figure


def draw_nis(run, comparison):
    series = [(m.label, m.nis) for m in run.measurements]
    if run.fused_nis is not None:
        series.append(("fused", run.fused_nis))
    series = [(label, np.where(nis > 0, nis, np.nan)) for label, nis in series]
    series = [(label, nis) for label, nis in series if np.isfinite(nis).any()]
    if not series:
        raise NotAvailable("the run carries no normalised innovations")
    figure, axes = style.figure(len(series), height_in=1.6 * len(series) + 0.9, sharey=True)
    for panel, (label, nis) in zip(axes[:, 0], series):
        style.shade_faults(panel, run.faults, run.stamp_s[0])
        panel.axhspan(CHI2_6_LOW, CHI2_6_HIGH, color=style.GREEN, alpha=0.15, linewidth=0,
                      label="95 % of a consistent filter's (6 degrees of freedom)")
        panel.plot(run.time_s, nis, ".", color=style.BLUE, markersize=3, label="one sweep")
        known = nis[np.isfinite(nis)]
        inside = np.mean((known >= CHI2_6_LOW) & (known <= CHI2_6_HIGH))
        panel.set_title(f"{label}: {100 * inside:.0f} % inside, median {np.median(known):.2g}", loc="right", fontsize=9.5)
        panel.set(yscale="log", ylabel="NIS (-)")
    axes[-1, 0].set(xlabel="time since the first sweep (s)", xlim=(0, run.end_s))
    known = np.concatenate([nis[np.isfinite(nis)] for _, nis in series])
    axes[0, 0].set_ylim(min(0.5, np.percentile(known, 1) / 2), max(40, 2 * known.max()))  # shared by all
    style.legend(axes[0, 0])
    return figure

"""How the pictures look: colours that colour-blind readers can tell apart (Okabe and Ito), axes, legends, encoding."""
import base64
import io

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402

BLACK, GREY, LIGHT = "#000000", "#777777", "#c8c8c8"
BLUE, SKY, GREEN, ORANGE, VERMILLION, PURPLE, YELLOW = (
    "#0072b2", "#56b4e9", "#009e73", "#e69f00", "#d55e00", "#cc79a7", "#f0e442")

TRUTH, ESTIMATE, LIMIT, BAND = BLACK, BLUE, VERMILLION, SKY
STATE_COLOURS = {"UNKNOWN": LIGHT, "OK": GREEN, "DEGRADED": YELLOW, "FAILING": ORANGE, "FAILED": VERMILLION}
SERIES = [BLUE, ORANGE, GREEN, PURPLE, VERMILLION, SKY, GREY]

WIDTH_IN = 10.5


def figure(rows=1, height_in=3.6, sharex=True, **kwargs):
    plt.rcParams.update({"font.size": 10.5, "axes.titlesize": 11, "axes.spines.top": False, "axes.spines.right": False,
                         "axes.grid": True, "grid.alpha": 0.25, "grid.linewidth": 0.7, "legend.frameon": False,
                         "axes.axisbelow": True, "lines.linewidth": 1.5, "figure.constrained_layout.use": True})
    return plt.subplots(rows, 1, sharex=sharex, figsize=(WIDTH_IN, height_in), squeeze=False, **kwargs)


def legend(axes, handles=None, columns=6):
    """Above the axes, where there is no data."""
    if handles is None:
        handles = axes.get_legend_handles_labels()[0]
    if handles:
        axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=columns, borderaxespad=0.2,
                    handlelength=1.8, columnspacing=1.4, fontsize=9.5)


def period_of(time_s):
    return float(np.median(np.diff(time_s))) if len(time_s) > 1 else 0.1


def spans(time_s, values, gaps=False):
    """[(value, (start, length))]: runs of equal values. Each holds until the next one; with `gaps` no longer than 2.5
    periods, so that missing sweeps show."""
    period = period_of(time_s)
    ends = np.append(time_s[1:], time_s[-1] + period)
    broken = gaps & (ends - time_s > 2.5 * period)
    ends = np.where(broken, time_s + period, ends)
    found, start = [], 0
    for i in range(1, len(values) + 1):
        if i == len(values) or values[i] != values[start] or broken[i - 1]:
            found.append((values[start], (time_s[start], ends[i - 1] - time_s[start])))
            start = i
    return found


def with_gaps(time_s, values):
    """For a line that breaks where sweeps are missing."""
    after = np.flatnonzero(np.diff(time_s) > 2.5 * period_of(time_s)) + 1
    return np.insert(time_s, after, np.nan), np.insert(values, after, np.nan)


def bars(axes, spans_, bottom, height, colour):
    """At least wide enough to be seen."""
    if spans_:
        axes.broken_barh(spans_, (bottom, height), facecolors=colour, edgecolors=colour, linewidth=0.5)


def mark_t1(axes, time_s, label=None):
    if time_s is not None and time_s > 0:
        axes.axvline(time_s, color=GREY, linestyle=(0, (1, 2)), linewidth=1.4, label=label)


def shade_faults(axes, faults, begin_s, label=True):
    """Light columns where a fault was on."""
    for i, fault in enumerate(faults):
        start = fault.start_s - begin_s
        axes.axvspan(start, start + max(fault.duration_s, 0.1), color=PURPLE, alpha=0.16, linewidth=0,
                     label="fault" if label and i == 0 else None)


def patch(colour, label, alpha=1.0):
    return Patch(facecolor=colour, alpha=alpha, label=label)


def png_base64(figure_):
    buffer = io.BytesIO()
    figure_.savefig(buffer, format="png", dpi=130)
    plt.close(figure_)
    return base64.b64encode(buffer.getvalue()).decode("ascii")

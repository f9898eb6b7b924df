"""The trajectory from above, in the frame at t1, with uncertainty ellipses."""
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse

from . import poses, style
from .run import NotAvailable

CHI2_95_2D = 5.991
MAGNIFICATIONS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
MOST_OF_SPAN = 0.12  # a larger ellipse hides the rest


def draw(run, comparison):
    if run.T_odom_base is None:
        raise NotAvailable("the run has no trajectory")
    begin = run.t1_index if comparison is None else comparison.begin
    estimate = poses.relative_to(run.T_odom_base, begin)[:, :3, 3]
    truth = None if comparison is None else np.where(comparison.covered[:, None], comparison.truth[:, :3, 3], np.nan)
    shown = estimate if truth is None else np.vstack([estimate, truth[comparison.covered]])
    low, high = shown[:, :2].min(axis=0), shown[:, :2].max(axis=0)
    span = max(high - low)
    figure, ((axes,),) = style.figure(height_in=_height(low, high))
    if truth is not None:
        axes.plot(truth[:, 0], truth[:, 1], color=style.TRUTH, linewidth=3.2, alpha=0.45, solid_capstyle="butt",
                  label="truth")
    axes.plot(estimate[begin:, 0], estimate[begin:, 1], color=style.ESTIMATE, label="odometry")
    if begin > 0:
        axes.plot(estimate[:begin + 1, 0], estimate[:begin + 1, 1], color=style.ESTIMATE, linestyle=(0, (1, 1.5)),
                  label="odometry before t1")
    handles = axes.get_legend_handles_labels()[0]
    handles += _ellipses(axes, run, estimate, begin, span)
    handles += _points(axes, run, estimate, begin, comparison)
    axes.set(xlabel="x, forward at t1 (m)", ylabel="y, left at t1 (m)")
    margin = 0.06 * span + 1.0
    axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
    axes.set_aspect("equal", adjustable="datalim")
    style.legend(axes, handles, columns=4)
    return figure


def _height(low, high):
    width, height = high - low
    return float(np.clip(1.4 + 9.3 * (height + 2) / max(width + 2, 1e-3), 3.6, 8.5))


def _ellipses(axes, run, estimate, begin, span):
    """A dozen along the way, magnified where they would not be seen, left out where they would hide all else."""
    if run.covariance is None or run.t1_s is None:
        return []
    along = poses.distance(run.T_odom_base)
    goals = np.linspace(along[begin], along[-1], 13)[1:]
    at = np.unique(np.searchsorted(along, goals - 1e-9).clip(begin, len(along) - 1))
    blocks = [run.covariance[i, :2, :2] for i in at]
    axes_m = [np.sqrt(CHI2_95_2D * np.clip(np.linalg.eigvalsh(block), 0, None)) for block in blocks]
    limit_m = MOST_OF_SPAN * span
    drawn = [n for n, pair in enumerate(axes_m) if pair[1] <= limit_m]
    largest = max((axes_m[n][1] for n in drawn), default=0.0)
    if largest <= 0:
        return []
    wanted = 0.035 * span / largest
    factor = max([m for m in MAGNIFICATIONS if m <= max(wanted, 1)])
    for i, block in ((at[n], blocks[n]) for n in drawn):
        values, vectors = np.linalg.eigh(block)
        width, height = 2 * factor * np.sqrt(CHI2_95_2D * np.clip(values[::-1], 0, None))
        angle = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
        axes.add_patch(Ellipse(estimate[i, :2], width, height, angle=angle, facecolor=style.BAND, alpha=0.35,
                               edgecolor=style.BLUE, linewidth=1.0))
    size = "" if factor == 1 else f", {factor} x larger than true"
    left_out = "" if len(drawn) == len(at) else f" (those beyond {limit_m:.2g} m not shown)"
    return [style.patch(style.BAND, f"95 % ellipse since t1{size}{left_out}", alpha=0.5)]


def _points(axes, run, estimate, begin, comparison):
    handles = []

    def point(index, marker, colour, label):
        axes.plot(*estimate[index, :2], marker, color=colour, markersize=9, markeredgecolor="white", zorder=5)
        handles.append(Line2D([], [], marker=marker, color=colour, linestyle="", markersize=8, label=label))

    point(0, "o", style.GREEN, "start")
    if run.t1_s is not None and begin > 0:
        point(begin, "D", style.GREY, "t1")
    if comparison is not None and comparison.failure is not None:
        point(comparison.index[comparison.failure], "X", style.LIMIT, f"error passes {run.alert_limit_m:g} m")
    point(len(estimate) - 1, "s", style.BLUE, "end")
    return handles

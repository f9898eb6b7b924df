"""Error over the distance since t1: horizontal, vertical, heading, each with the odometry's own 1, 2, 3 sigma."""
import numpy as np

from . import style
from .run import NotAvailable

SHADES = ((3, 0.16), (2, 0.26), (1, 0.42))
LOG_FROM = 20.0  # times the alert limit


def draw(run, comparison):
    if comparison is None:
        raise NotAvailable(run.why_no_truth)
    figure, ((horizontal,), (vertical,), (heading,)) = style.figure(3, height_in=8.0)
    x = comparison.distance_m
    sigma = _sigmas(run, comparison)
    _bands(horizontal, x, sigma and sigma[0], signed=False)
    horizontal.plot(x, comparison.horizontal_m, color=style.ESTIMATE, label="error")
    horizontal.axhline(run.alert_limit_m, color=style.LIMIT, linestyle="--", label=f"alert limit {run.alert_limit_m:g} m")
    if comparison.failure is not None:
        horizontal.plot(x[comparison.failure], comparison.horizontal_m[comparison.failure], "X", color=style.LIMIT,
                        markersize=9, markeredgecolor="white", label="passed")
    _scale_horizontal(horizontal, comparison.horizontal_m, run.alert_limit_m, sigma and sigma[0])
    _bands(vertical, x, sigma and sigma[1], signed=True)
    vertical.plot(x, comparison.error[:, 2], color=style.ESTIMATE)
    vertical.set_ylabel("vertical (m)")
    _bands(heading, x, sigma and sigma[2], signed=True)
    heading.plot(*_unjoined_wraps(x, np.degrees(comparison.heading_rad)), color=style.ESTIMATE)
    heading.set_ylabel("heading (deg)")
    for axes, values, band in ((vertical, comparison.error[:, 2], sigma and sigma[1]),
                               (heading, np.degrees(comparison.heading_rad), sigma and sigma[2])):
        _symmetric(axes, values, band)
    heading.set_xlabel("true distance driven since t1 (m)" if run.t1_s is not None
                       else "true distance driven since the first sweep (m)")
    style.legend(horizontal, columns=6)
    figure.align_ylabels()
    return figure


def _unjoined_wraps(x, degrees):
    """From +180 to -180 deg is no way through 0."""
    after = np.flatnonzero(np.abs(np.diff(degrees)) > 180.0) + 1
    return np.insert(x, after, np.nan), np.insert(degrees, after, np.nan)


def _sigmas(run, comparison):
    """(horizontal m, vertical m, heading deg); the horizontal one is the root of the expected squared error."""
    if run.covariance is None or run.t1_s is None:
        return None
    C = run.covariance[comparison.index]
    root = [np.sqrt(np.clip(v, 0, None)) for v in (C[:, 0, 0] + C[:, 1, 1], C[:, 2, 2], C[:, 5, 5])]
    return root[0], root[1], np.degrees(root[2])


def _bands(axes, x, sigma, signed):
    if sigma is None:
        return
    for factor, alpha in SHADES:
        low = -factor * sigma if signed else np.zeros_like(sigma)
        axes.fill_between(x, low, factor * sigma, color=style.BAND, alpha=alpha, linewidth=0,
                          label=f"{factor} sigma" if not signed else None)


def _scale_horizontal(axes, error, limit, sigma):
    axes.set_ylabel("horizontal (m)")
    if error.max() > LOG_FROM * limit:
        axes.set_yscale("log")
        axes.set_ylim(limit / 60, 1.5 * error.max())
        axes.set_ylabel("horizontal (m), log scale")
        return
    top = max(error.max(), limit)
    if sigma is not None:
        top = max(top, min(3 * sigma.max(), 2.5 * top))
    axes.set_ylim(0, 1.08 * top)


def _symmetric(axes, values, band):
    top = np.abs(values).max()
    if band is not None:
        top = max(top, min(3 * np.max(band), 4 * top if top > 0 else 3 * np.max(band)))
    if top > 0:
        axes.set_ylim(-1.1 * top, 1.1 * top)

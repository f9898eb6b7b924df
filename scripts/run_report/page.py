"""The page: one HTML file, pictures inside."""
import html

from offline_tools import progress
from . import (comparison as comparisons, figure_error, figure_indicator, figure_measurements, figure_road_ahead,
               figure_stage_times, figure_time_to_failure, figure_timeline, figure_trajectory, style, summary)
from .run import NotAvailable

SECTIONS = [
    ("trajectory", "Trajectory", figure_trajectory.draw,
     "From above; odometry and truth are aligned at t1, in position and heading. An ellipse contains the true position "
     "with a probability of 95 %, by the odometry's own covariance since t1."),
    ("error", "Error over distance", figure_error.draw,
     "Against the truth, since t1. The bands are the odometry's own covariance. If it is calibrated, the error is within "
     "1 sigma for about two thirds of the distance, and rarely beyond 3 sigma."),
    ("indicator", "Fail-aware indicator", figure_indicator.draw,
     "The article's figure: (a) heading uncertainty of the filter, (b) the indicator eta, the sum of its changes, with its "
     "threshold, (c) the true horizontal error."),
    ("time_to_failure", "Time to failure", figure_time_to_failure.draw,
     "Predicted against true. A prediction above the truth is late (unsafe), one below it is early. At the top edge: "
     "beyond the horizon. Gaps: unknown. If the error does not pass the alert limit before the end, the true time is not "
     "known; it is longer than the dotted line, the time that is left to the end."),
    ("road_ahead", "Road ahead", figure_road_ahead.draw,
     "Of what the walls in view say of the horizontal position, the ratio along the road, on the weakest stretch ahead, and "
     "how far away that begins. On roads it is 0.02 to 0.3, in a smooth tunnel 0.001. Gaps: not known."),
    ("timeline", "States, reasons, faults", figure_timeline.draw,
     "State and reasons in the message to the planner, sweep by sweep; below them, the simulated faults."),
    ("weights", "Weights of the measurements", figure_measurements.draw_weights,
     "1: the measurement equals the prediction. Gated out: the pose is too far from the prediction. No pose: the status of "
     "the measurement gives the reason."),
    ("nis", "Normalised innovations", figure_measurements.draw_nis,
     "Distance of each measurement from the prediction, in units of their joint covariance. Below the band: the covariance "
     "is too large; above: too small."),
    ("stage_times", "Time of the stages", figure_stage_times.draw,
     "Offline: computing time, without reading files. Live: see the labels."),
]

STYLE = """
body { font: 16px/1.45 sans-serif; color: #1a1a1a; max-width: 1080px; margin: 1.5em auto; padding: 0 1em; }
h1 { font-size: 1.6em; margin-bottom: 0.2em; } h2 { font-size: 1.2em; margin: 1.8em 0 0.2em; }
p { margin: 0.2em 0 0.6em; max-width: 60em; } p.why { color: #8a4b00; }
table { border-collapse: collapse; margin: 0.8em 0; } td { padding: 0.2em 1.2em 0.2em 0; vertical-align: top; }
td:first-child { color: #555; white-space: nowrap; } tr { border-bottom: 1px solid #e4e4e4; }
img { width: 100%; height: auto; }
"""


def build(run, trajectory):
    """The table's rows, and the page's text."""
    comparison = None
    try:
        comparison = comparisons.compare(run, trajectory)
    except NotAvailable as why:
        run.why_no_truth = str(why)
    table = summary.rows(run, comparison)
    parts = ["<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Odometry report</title>",
             f"<style>{STYLE}</style></head><body>", "<h1>Fail-aware lidar odometry: report of a run</h1>",
             _table(table)]
    for drawn, (key, title, draw, text) in enumerate(SECTIONS):
        progress(drawn, len(SECTIONS), "pictures")
        parts.append(f'<section id="{key}"><h2>{html.escape(title)}</h2>')
        try:
            picture = style.png_base64(draw(run, comparison))
            parts.append(f"<p>{html.escape(text)}</p>")
            parts.append(f'<img alt="{html.escape(title)}" src="data:image/png;base64,{picture}">')
        except NotAvailable as why:
            parts.append(f'<p class="why">No picture: {html.escape(str(why))}.</p>')
        parts.append("</section>")
    progress(len(SECTIONS), len(SECTIONS), "pictures")
    parts.append("</body></html>\n")
    return table, "\n".join(parts)


def _table(rows):
    cells = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(value)}</td></tr>" for name, value in rows)
    return f"<table>{cells}</table>"

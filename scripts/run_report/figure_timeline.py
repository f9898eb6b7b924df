"""State, reasons and faults over time, a row each."""
from offline_tools import STATES

from . import style
from .run import NotAvailable


def draw(run, comparison):
    monitor = run.monitor
    if monitor is None or monitor.state is None:
        raise NotAvailable("the run carries no state (time_to_failure)")
    rows = [("state", [(style.STATE_COLOURS.get(name, style.BLACK), span)
                       for name, span in style.spans(run.monitor_time_s, monitor.state)])]
    for reason in _reasons(monitor):
        on = style.spans(run.monitor_time_s, [reason in reasons for reasons in monitor.reasons])
        rows.append((reason, [(style.BLUE, span) for present, span in on if present]))
    rows += [(label, [(style.PURPLE, span) for span in found]) for label, found in _faults(run)]
    figure, ((axes,),) = style.figure(height_in=1.6 + 0.33 * len(rows))
    for i, (label, coloured) in enumerate(rows):
        height = 0.86 if label == "state" else 0.62
        for colour in dict.fromkeys(colour for colour, _ in coloured):
            style.bars(axes, [span for c, span in coloured if c == colour], -i - height / 2, height, colour)
    style.mark_t1(axes, run.serving_from_s, "t1")
    if comparison is not None and comparison.failure is not None:
        axes.axvline(comparison.time_s[comparison.failure], color=style.BLACK, linewidth=1.4,
                     label=f"error passes {run.alert_limit_m:g} m")
    axes.set(xlabel="time since the first sweep (s)", xlim=(0, run.end_s), ylim=(-len(rows) + 0.4, 0.6))
    axes.set_yticks([-i for i in range(len(rows))])
    axes.set_yticklabels([label for label, _ in rows], fontsize=9)
    axes.grid(axis="y", visible=False)
    present = set(monitor.state)
    handles = [style.patch(style.STATE_COLOURS[name], name) for name in STATES if name in present]
    style.legend(axes, handles + axes.get_legend_handles_labels()[0], columns=7)
    return figure


def _reasons(monitor):
    """By their first appearance."""
    found = []
    for reasons in monitor.reasons or []:
        found += [reason for reason in reasons if reason not in found]
    return found


def _faults(run):
    """[("fault: fog", [(start, length)])], one row a kind."""
    rows = {}
    for fault in run.faults:
        rows.setdefault(f"fault: {fault.kind}", []).append((fault.start_s - run.stamp_s[0], max(fault.duration_s, 0.1)))
    return list(rows.items())

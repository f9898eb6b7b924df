"""The aggregate as one HTML page with two pictures: coverage of the covariance and reliability of the time to failure."""
import html

from run_report import style

from . import aggregate

EXPECTED_WITHIN = (0.393, 0.865, 0.989)  # of a horizontal error with a true covariance


def write(output, found):
    parts = [f"<h1>{len(found['judged'])} of {found['recordings']} recordings</h1>", provenance_lines(found),
             "<h2>Alarm rates and the planner's figure</h2>",
             f"<p>Starts that share no driving; exact {100 * found['interval_level']:.0f} % intervals (Poisson; Clopper and "
             "Pearson), then the number of events.</p>"]
    parts += [markdown_table(aggregate.table_for_document(found, tag)) for tag in list(found["tags"]) or [""]]
    without = found[aggregate.ALL]["without_start"]
    if without:
        parts.append(f"<p>No start, since no motion was observed: {html.escape(', '.join(without))}</p>")
    parts += ["<h2>Accuracy</h2>"] + [accuracy_table(found, tag) for tag in list(found["tags"]) or [""]]
    parts += ["<h2>Calibration</h2>", '<img src="coverage.png" alt="coverage">', '<img src="reliability.png" alt="reliability">']
    draw_coverage(output / "coverage.png", found)
    draw_reliability(output / "reliability.png", found)
    pooled = found["pooled"]
    parts.append("<p>All episodes together: " + ('<a href="table.txt">table</a>, <a href="fail_aware.json">JSON</a>, which '
                 "plot_fail_aware draws" if not pooled else html.escape(pooled)) + "</p>")
    parts += ["<h2>The worst recordings</h2>", worst_table(found["worst"])]
    if found["not_judged"]:
        parts += ["<h2>Not judged</h2>", rows_table(("recording", "status", "why"), [
            (row["name"], row["status"], row["error"]) for row in found["not_judged"]])]
    (output / "index.html").write_text(
        "<!DOCTYPE html><meta charset=utf-8><title>Fleet</title><style>body{font:15px sans-serif;max-width:75em;margin:2em "
        "auto}table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #ccc;padding:.2em .6em;text-align:left}img{max-"
        "width:100%}</style>\n" + "\n".join(parts) + '\n<p><a href="recordings.csv">every recording</a>, '
        '<a href="aggregate.json">all figures</a></p>\n')


def provenance_lines(found):
    versions = ", ".join(f"{version}: {count}" for version, count in found["versions"].items())
    parameters = ", ".join(f"{checksum[:12]}: {count}" for checksum, count in found["parameters_sha256"].items())
    return f"<p>Version and number of recordings: {html.escape(versions)}<br>Parameters' checksum: {html.escape(parameters)}</p>"


def rows_table(header, rows, raw=()):
    def cell(text, column):
        return f"<td>{text if column in raw else html.escape(str(text))}</td>"
    lines = ["<table><tr>" + "".join(f"<th>{html.escape(name)}</th>" for name in header) + "</tr>"]
    lines += ["<tr>" + "".join(cell(text, column) for column, text in enumerate(row)) + "</tr>" for row in rows]
    return "\n".join(lines + ["</table>"])


def markdown_table(text):
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()]
    return rows_table(rows[0], rows[2:])


def accuracy_table(found, tag):
    rows = []
    for value, of_value in list(found["tags"].get(tag, {}).items()) + [(aggregate.ALL, found[aggregate.ALL])]:
        a = of_value["accuracy"]
        rows.append((value, a["recordings"], aggregate.number(a["driven_h"]), aggregate.number(a["distance_km"]),
                     aggregate.number(a["t_err_percent"]), aggregate.number(a["r_err_deg_per_m"]),
                     aggregate.number(a["largest_error_m"])))
    return rows_table((tag or "recordings", "recordings", "hours", "km", "translation error, %", "rotation error, deg/m",
                       "largest error, m"), rows)


def worst_table(worst):
    rows = [(f'<a href="{html.escape(row["report"])}">{html.escape(row["name"])}</a>', row["missed"], row["failed"],
             row["false_alarms"], row["starts"], aggregate.number(row["largest_error_m"]), aggregate.number(row["distance_m"]))
            for row in worst]
    return rows_table(("recording", "missed", "failures", "false alarms", "starts", "largest error, m", "distance, m"), rows,
                      raw=(0,))


def draw_coverage(path, found):
    groups = [(f"{tag} {value}", f) for tag, values in found["tags"].items() for value, f in values.items()]
    groups = [(label, f["coverage"]) for label, f in groups + [(aggregate.ALL, found[aggregate.ALL])] if f["coverage"]["samples"]]
    figure, axes = style.figure(height_in=1.5 + 0.3 * max(1, len(groups)))
    panel = axes[0, 0]
    for row, (label, c) in enumerate(groups):
        for k, colour in enumerate((style.BLUE, style.ORANGE, style.GREEN)):
            panel.plot(100 * c["within_1_2_3_sigma"][k], -row, "o", color=colour, label=f"within {k + 1} sigma" if row == 0 else None)
    for k, expected in enumerate(EXPECTED_WITHIN):
        panel.axvline(100 * expected, color=style.GREY, linestyle="--", label="expected" if k == 0 else None)
    panel.set(xlabel="true position inside, % of the seconds", xlim=(0, 101), yticks=[-row for row in range(len(groups))],
              yticklabels=[f"{label} (NEES {c['nees_per_dof']:.2f})" for label, c in groups])
    style.legend(panel)
    save(figure, path)


def draw_reliability(path, found):
    bins = [b for b in found[aggregate.ALL]["reliability"] if b["interval"]]
    figure, axes = style.figure()
    panel = axes[0, 0]
    for at, b in enumerate(bins):
        low, high = b["interval"]
        panel.plot([at, at], [100 * low, 100 * high], color=style.BLUE)
        panel.plot(at, 100 * b["ratio"], "o", color=style.BLUE)
    panel.set(xlabel="predicted time to failure, s", ylabel="failed sooner (late), %", xticks=range(len(bins)),
              xticklabels=[f"{b['from_s']:g}..{b['to_s']:g}\n{b['whole']}" for b in bins])
    panel.set_ylim(bottom=0)
    panel.set_title("bars: 95 %, as if predictions were independent", loc="right", fontsize=9.5)
    save(figure, path)


def save(figure, path):
    figure.savefig(path, dpi=80, metadata={"Software": None})
    style.plt.close(figure)

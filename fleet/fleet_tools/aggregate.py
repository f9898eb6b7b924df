"""The fleet's figures from the recordings' results: sums over recordings, so their number does not matter, and exact
intervals.

Overlapping starts share driving, so their failures are not independent, and no exact interval holds for them. Rates and
ratios with intervals are therefore those of the starts that share none ("apart", steps.py): each second of driving counts
once. The figures of all starts are beside them, without intervals.
"""
import collections
import csv
import json
import math
import pathlib
import subprocess

from offline_tools import find_tool, last_line

from . import intervals, names, provenance, steps, table

ALL = "all"
WORST = 20
COUNTS = ("failed", names.MISSED, names.FALSE_ALARMS, "stoppable", "in_time", "unstoppable", "told", "sound", "sound_stopped")
TIMES = (names.WATCHED, names.ALARM, names.UNKNOWN, "used_s", "could_s", "sound_used_s", "sound_could_s")


def share(part, whole):
    return part / whole if whole else None


def rate(events, hours):
    return {"events": events, "hours": hours, "per_hour": share(events, hours),
            "interval": intervals.poisson_rate(events, hours)}


def ratio(part, whole):
    return {"part": part, "whole": whole, "ratio": share(part, whole), "interval": intervals.clopper_pearson(part, whole)}


def sums(starts):
    total = {"starts": len(starts)}
    for name in COUNTS:
        total[name] = sum(start[name] for start in starts)
    for name in TIMES:
        total[name] = math.fsum(start[name] for start in starts)
    total["starts_with_false_alarm"] = sum(start[names.FALSE_ALARMS] > 0 for start in starts)
    return total


def figures_of_starts(starts):
    """Alarm rates and the planner's figure of starts that share no driving."""
    total = sums(starts)
    watched_h = total[names.WATCHED] / 3600
    without_alarm_h = (total[names.WATCHED] - total[names.ALARM]) / 3600
    return {"starts": total["starts"], "watched_h": watched_h,
            "failures": rate(total["failed"], watched_h),
            "missed_failures": rate(total[names.MISSED], watched_h),
            "missed_of_failures": ratio(total[names.MISSED], total["failed"]),
            "false_alarms": rate(total[names.FALSE_ALARMS], without_alarm_h),
            "starts_with_false_alarm": ratio(total["starts_with_false_alarm"], total["starts"]),
            "alarm_ratio": share(total[names.ALARM], total[names.WATCHED]),
            "available_ratio": share(total[names.WATCHED] - total[names.ALARM] - total[names.UNKNOWN], total[names.WATCHED]),
            "planner": {"in_time": ratio(total["in_time"], total["stoppable"]),
                        "told": ratio(total["told"], total["unstoppable"]),
                        "sound_stopped": ratio(total["sound_stopped"], total["sound"]),
                        "used": share(total["used_s"] + total["sound_used_s"], total["could_s"] + total["sound_could_s"]),
                        "used_failing": share(total["used_s"], total["could_s"]),
                        "used_sound": share(total["sound_used_s"], total["sound_could_s"])}}


def accuracy(results):
    """KITTI's errors, weighted by segments; the largest error of position."""
    of_trajectory = [r["trajectory"] for r in results if r["trajectory"][names.SEGMENTS]]
    segments = sum(t[names.SEGMENTS] for t in of_trajectory)

    def mean(name):
        return share(math.fsum(t[name] * t[names.SEGMENTS] for t in of_trajectory), segments)
    return {"recordings": len(results), "driven_h": math.fsum(r["driven_s"] for r in results) / 3600,
            "distance_km": math.fsum(r["trajectory"][names.PATH_LENGTH] for r in results) / 1000,
            "segments": segments, "t_err_percent": mean(names.TRANSLATION_ERROR), "r_err_deg_per_m": mean(names.ROTATION_ERROR),
            "largest_error_m": max((r["trajectory"][names.ATE_MAX] for r in results), default=None)}


def coverage(results):
    """How often the true position lies within 1, 2, 3 sigma, and NEES/dof."""
    known = [r["coverage"] for r in results if r["coverage"]]
    samples = sum(c[names.SAMPLES] for c in known)
    within = [math.fsum(c[names.WITHIN_SIGMA][k] * c[names.SAMPLES] for c in known) for k in range(3)]
    return {"samples": samples, "within_1_2_3_sigma": [share(w, samples) for w in within],
            "nees_per_dof": share(math.fsum(c[names.MEAN_PER_DOF] * c[names.SAMPLES] for c in known), samples)}


def reliability(results):
    """Of the predictions of so many seconds, how many failed within them."""
    bins = collections.OrderedDict()
    for r in results:
        for b in r["reliability"]:
            of_bin = bins.setdefault((b[names.BIN_FROM], b[names.BIN_TO]), [0, 0])
            of_bin[0] += b[names.BIN_FAILED_WITHIN]
            of_bin[1] += b[names.BIN_DECIDED]
    return [{"from_s": low, "to_s": high, **ratio(failed, decided)} for (low, high), (failed, decided) in bins.items()]


def figures(results):
    all_starts = [start for r in results for start in r["starts"]]
    total = sums(all_starts)
    return {"accuracy": accuracy(results), "without_start": [r["name"] for r in results if not r["starts"]],
            "apart": figures_of_starts([start for start in all_starts if start["apart"]]),
            "all_starts": {key: total[key] for key in ("starts", "failed", names.MISSED, names.FALSE_ALARMS, names.WATCHED,
                                                       names.ALARM)} |
            {"in_time": share(total["in_time"], total["stoppable"]), "told": share(total["told"], total["unstoppable"]),
             "used": share(total["used_s"] + total["sound_used_s"], total["could_s"] + total["sound_could_s"])},
            "coverage": coverage(results), "reliability": reliability(results)}


def badness(result):
    """Worst first: failures that no alarm told of, then failures, then false alarms, then the error over the distance."""
    starts = result["starts"]
    return (sum(s[names.MISSED] for s in starts), sum(s["failed"] for s in starts),
            sum(s[names.FALSE_ALARMS] for s in starts),
            share(result["trajectory"][names.ATE_MAX], result["trajectory"][names.PATH_LENGTH]) or 0.0)


def worst_row(result):
    missed, failed, false_alarms, _ = badness(result)
    return {"name": result["name"], "missed": missed, "failed": failed, "false_alarms": false_alarms,
            "starts": len(result["starts"]), "largest_error_m": result["trajectory"][names.ATE_MAX],
            "distance_m": result["trajectory"][names.PATH_LENGTH], "report": f"../runs/{result['name']}/report.html"}


def aggregate(recordings, results_folder, parameter_files):
    """The whole aggregate. Recordings without a result are named, those that parameters were fitted on are not judged."""
    fitted = provenance.fitted_on(parameter_files)
    judged, not_judged = [], []
    for name in recordings:
        file = pathlib.Path(results_folder) / name / "result.json"
        if not file.exists():
            not_judged.append({"name": name, "status": "no result", "error": "the workflow did not finish it"})
            continue
        result = steps.read_json(file)
        if result["status"] != steps.OK:
            not_judged.append({"name": name, "status": result["status"], "error": result["error"]})
        elif result["identity"] in fitted:
            not_judged.append({"name": name, "status": "fitted on", "error": "the parameters were fitted on this recording"
                               f" ({fitted[result['identity']]})"})
        else:
            judged.append(result)
    tags = {}
    for tag in table.tag_names(recordings):
        by_value = collections.defaultdict(list)
        for result in judged:
            by_value[recordings[result["name"]].tags[tag]].append(result)
        tags[tag] = {value: figures(by_value[value]) for value in sorted(by_value)}
    return {"versions": count(version_of(r) for r in judged), "parameters_sha256": count(r["parameters_sha256"] for r in judged),
            "interval_level": intervals.LEVEL, "recordings": len(recordings), "judged": [r["name"] for r in judged],
            "not_judged": not_judged, ALL: figures(judged), "tags": tags,
            "worst": [worst_row(r) for r in sorted(judged, key=lambda r: (badness(r), r["name"]), reverse=True)[:WORST]]}


def version_of(result):
    run, judged = result["version"], result["judged_version"]
    return run if run == judged else f"{run}, judged by {judged}"


def count(values):
    return dict(sorted(collections.Counter(values).items()))


def pooled(names_judged, results_folder, output, resamples, largest_h, driven_h):
    """evaluate_fail_aware over all episodes together, as over all runs at once: concordance and its baselines. Its cost
    grows with the square of the driving."""
    output = pathlib.Path(output)
    for left in (names.FAIL_AWARE, names.PREDICTIONS, names.EPISODES, "table.txt"):
        (output / left).unlink(missing_ok=True)
    if not names_judged:
        return "no recording was judged"
    if driven_h > largest_h:
        return f"{driven_h:.1f} h are more than pooled_hours: {largest_h:g}"
    command = [find_tool("evaluate_fail_aware"), "--output", str(output), "--resamples", str(resamples)]
    for name in names_judged:
        command += ["--episodes", str(pathlib.Path(results_folder) / name / names.KEPT_EPISODES)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        return f"evaluate_fail_aware: {last_line(done.stderr)}"
    (output / "table.txt").write_text(done.stdout)
    return ""


def write_recordings(path, recordings, results_folder):
    """One row a recording."""
    tags = table.tag_names(recordings)
    columns = ["name", "status", "error", "version", "parameters_sha256", "driven_s", "distance_m", "t_err_percent", "starts",
               "failed", "missed", "false_alarms"]
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns + [table.TAG + tag for tag in tags])
        writer.writeheader()
        for name, recording in recordings.items():
            row = {"name": name, "status": "no result"} | {table.TAG + tag: recording.tags[tag] for tag in tags}
            result_file = pathlib.Path(results_folder) / name / "result.json"
            if result_file.exists():
                result = steps.read_json(result_file)
                row.update({column: result[column] for column in ("status", "error", "version")})
                if result["status"] == steps.OK:
                    trajectory, starts = result["trajectory"], result["starts"]
                    row.update(parameters_sha256=result["parameters_sha256"], driven_s=result["driven_s"],
                               distance_m=trajectory[names.PATH_LENGTH], t_err_percent=trajectory[names.TRANSLATION_ERROR],
                               starts=len(starts), failed=sum(s["failed"] for s in starts),
                               missed=sum(s[names.MISSED] for s in starts),
                               false_alarms=sum(s[names.FALSE_ALARMS] for s in starts))
            writer.writerow(row)


def run(arguments):
    """aggregate.json last: it stands for the step."""
    from . import page  # matplotlib is slow to load
    output, recordings = pathlib.Path(arguments.done).parent, table.read(arguments.table)
    output.mkdir(parents=True, exist_ok=True)
    if arguments.partial:
        print("aggregate: what is there by now")
    found = aggregate(recordings, arguments.results, arguments.parameters)
    found["pooled"] = pooled(found["judged"], arguments.results, output, arguments.resamples, arguments.pooled_hours,
                             found[ALL]["accuracy"]["driven_h"])
    write_recordings(output / "recordings.csv", recordings, arguments.results)
    page.write(output, found)
    steps.write_json(arguments.done, found)
    for left_out in found["not_judged"]:
        print(f"aggregate: not judged: {left_out['name']}: {left_out['status']}: {left_out['error']}")
    if len(found["versions"]) > 1:
        print("aggregate: the results are of several versions; --forceall makes them anew")
    print(f"aggregate: {len(found['judged'])} of {len(recordings)} recordings, {output / 'index.html'}")


def table_for_document(found, tag):
    """Markdown: alarm rates, a row for each value of the tag and one for all ("": only that)."""
    rows = [(value, of_value) for value, of_value in found["tags"].get(tag, {}).items()] + [(ALL, found[ALL])]
    lines = [f"| {tag or 'recordings'} | hours | starts | failures per h | missed, of the failures | false alarms per h | "
             "alarm up | in time | used |", "|---|---|---|---|---|---|---|---|---|"]
    for value, of_value in rows:
        f = of_value["apart"]
        lines.append(f"| {value} | {f['watched_h']:.2f} | {f['starts']} | {rate_text(f['failures'])} | "
                     f"{ratio_text(f['missed_of_failures'])} | {rate_text(f['false_alarms'])} | "
                     f"{percent(f['alarm_ratio'])} | {ratio_text(f['planner']['in_time'])} | "
                     f"{percent(f['planner']['used'])} |")
    return "\n".join(lines)


def number(value):
    """Three digits, no exponent."""
    if value is None or math.isinf(value):
        return "-"
    if value == 0:
        return "0"
    return f"{value:.{max(0, 2 - math.floor(math.log10(abs(value))))}f}"


def percent(value):
    return "-" if value is None else f"{100 * value:.1f} %"


def rate_text(r):
    if r["interval"] is None:
        return "-"
    return f"{number(r['per_hour'])} ({number(r['interval'][0])}..{number(r['interval'][1])}; {r['events']})"


def ratio_text(r):
    if r["interval"] is None:
        return "- (none)"
    return f"{percent(r['ratio'])} ({100 * r['interval'][0]:.1f}..{100 * r['interval'][1]:.1f}; {r['part']} of {r['whole']})"


BEGIN, END = "<!-- fleet/validate: begin -->", "<!-- fleet/validate: end -->"


def print_table(arguments):
    """On the standard output, or in place of what a page has between BEGIN and END."""
    with open(arguments.aggregate) as file:
        found = json.load(file)
    text = (f"{found[ALL]['accuracy']['driven_h']:.2f} hours of driving, {found[ALL]['accuracy']['recordings']} drives, version "
            f"{', '.join(dict.fromkeys(version.split()[0] for version in found['versions']))}.\n\n" +
            "\n\n".join(table_for_document(found, tag) for tag in arguments.tags or [""]))
    if not arguments.into:
        print(text)
        return
    page = pathlib.Path(arguments.into)
    before, rest = page.read_text().split(BEGIN)
    page.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")

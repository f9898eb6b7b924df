"""Fits the parameters to some recordings and judges them on others, never on the same."""
import pathlib

from offline_tools import find_tool

from . import aggregate, provenance, steps, table


class Refused(Exception):
    pass


def choose(recordings, fit, judge):
    """(names to fit on, names to judge on). Raises Refused if there are none, or one is in both."""
    if not fit or not judge:
        raise Refused("calibrate needs tags to fit on and tags to judge on: calibrate: {fit: {TAG: VALUE}, judge: {TAG: VALUE}}")
    try:
        fitted, judged = table.chosen(recordings, fit), table.chosen(recordings, judge)
    except table.TableError as error:
        raise Refused(str(error))
    for what, chosen in (("fit", fitted), ("judge", judged)):
        if not chosen:
            raise Refused(f"no recording has the tags to {what} on")
    both = sorted(set(fitted) & set(judged))
    if both:
        raise Refused(f"{', '.join(both)}: to be fitted on and judged on; what was fitted on proves nothing")
    return fitted, judged


def usable(run_folders):
    """[(run folder, odometry.json)] of those that could be run."""
    done = [(pathlib.Path(folder), steps.read_json(pathlib.Path(folder) / "odometry.json")) for folder in run_folders]
    return [(folder, of_run) for folder, of_run in done if of_run["status"] == steps.OK]


def fit(arguments):
    """Writes noise.yaml, alarm.yaml, and fitted.yaml, which holds both and names the recordings."""
    output, runs = pathlib.Path(arguments.done).parent, usable(arguments.runs)
    if not runs:
        raise Refused("none of the recordings to fit on could be run")
    calibs = {(folder / "calib.txt").read_text() if (folder / "calib.txt").exists() else "" for folder, _ in runs}
    if len(calibs) > 1:
        raise Refused("the recordings to fit on have different files 'calib': calibrate_noise takes one for all")
    options = ["--calib", str(runs[0][0] / "calib.txt")] if calibs != {""} else []
    for folder, _ in runs:
        options += ["--ground-truth", str(folder / "truth.txt"), "--run", str(folder)]
    noise, alarm = output / "noise.yaml", output / "alarm.yaml"
    given = [option for file in arguments.parameters for option in ("--parameters", file)]
    steps.call([find_tool("calibrate_noise"), "--output", str(noise)] + options + given)
    steps.call([find_tool("calibrate_fail_aware"), "--output", str(alarm)] + options + given + ["--parameters", str(noise)])
    import yaml
    lines = [f"{provenance.FITTED_ON}{folder.name} {of_run['identity']}\n" for folder, of_run in runs]
    merged = merge(yaml.safe_load(noise.read_text()) or {}, yaml.safe_load(alarm.read_text()) or {})
    unfinished = pathlib.Path(arguments.done + ".unfinished")
    unfinished.write_text("".join(lines) + yaml.safe_dump(merged, sort_keys=False))
    unfinished.rename(arguments.done)
    print(f"calibrate: fitted on {len(runs)} recordings: {arguments.done}")


def merge(a, b):
    merged = dict(a)
    for key, value in b.items():
        merged[key] = merge(merged[key], value) if isinstance(value, dict) and isinstance(merged.get(key), dict) else value
    return merged


def judge(arguments):
    """Writes judged.json: the figures of the recordings to judge on, before and after."""
    fitted, recordings = provenance.fitted_on([arguments.fitted]), table.read(arguments.table)
    for name in arguments.names:
        of_run = steps.read_json(pathlib.Path(arguments.runs) / name / "odometry.json")
        if of_run.get("identity") in fitted:
            raise Refused(f"{name} is the drive {fitted[of_run['identity']]}, which was fitted on; what was fitted on proves "
                          "nothing")
    chosen = {name: recordings[name] for name in arguments.names}
    before = aggregate.aggregate(chosen, arguments.before, arguments.parameters)
    after = aggregate.aggregate(chosen, arguments.after, arguments.parameters + [arguments.fitted])
    for what, found in (("before", before), ("after", after)):
        print(f"calibrate: {what}, {len(found['judged'])} recordings: NEES of the position "
              f"{aggregate.number(found[aggregate.ALL]['coverage']['nees_per_dof'])}\n"
              f"{aggregate.table_for_document(found, '')}")
    steps.write_json(arguments.done, {"fitted_on": sorted(fitted.values()), "before": before, "after": after})

"""The work on one recording: made up or read, run, judged, reported. Each step ends with a file of its own, which stands
for the step and is written last: a step that was killed is made again, one that is done is not.

A recording that the tools cannot use (exit code 2), or that fails every time, is a result, too: its status says so.
"""
import contextlib
import csv
import fcntl
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import zlib

from offline_tools import find_tool, last_line

from . import SCRIPTS, names, planner_figure, provenance

OK, UNUSABLE, FAILED = "ok", "unusable", "failed"
STARTS_FROM_S = 3.0  # before that the growth of the covariance is a guess (doc/validation.md)


class StepError(Exception):
    """Worth another attempt."""


class Unusable(Exception):
    """The recording cannot be used, however often it is tried."""


def write_json(path, value):
    """Complete or not there."""
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f"{path.name}.unfinished_{os.getpid()}")
    unfinished.write_text(json.dumps(value, indent=1) + "\n")
    os.replace(unfinished, path)


def read_json(path):
    with open(path) as file:
        return json.load(file)


@contextlib.contextmanager
def alone(path):
    """One step at a time: a job that outlived a killed Snakemake ends before its successor begins."""
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def call(command, output=None):
    """Runs a tool. Raises Unusable for its exit code 2, StepError for any other failure."""
    tool = pathlib.Path(command[0]).name
    done = subprocess.run(command, stdout=output or subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
    if done.returncode == 0:
        return
    if done.returncode == 2:
        raise Unusable(_without_name(last_line(done.stderr), tool))
    if done.returncode < 0:
        raise StepError(f"{tool}: ended by {signal.Signals(-done.returncode).name}")
    raise StepError(f"{tool}: exit code {done.returncode}: {last_line(done.stderr)}")


def _without_name(line, tool):
    start = f"{tool}: error: "
    return f"{tool}: {line[len(start):]}" if line.startswith(start) else f"{tool}: {line}"


def simulate(arguments):
    """A made-up drive in a folder that is complete or not there."""
    drive = pathlib.Path(arguments.drive)
    unfinished = drive.with_name(f"{drive.name}.unfinished_{os.getpid()}")
    for left in [drive, *drive.parent.glob(drive.name + ".unfinished_*")]:
        shutil.rmtree(left, ignore_errors=True)
    try:
        call([find_tool("simulate_drive"), "--output", str(unfinished)] + arguments.simulate.split())
    except Unusable as error:  # the odometry step reports it
        unfinished.mkdir(parents=True, exist_ok=True)
        (unfinished / "unusable").write_text(f"{error}\n")
    unfinished.rename(drive)


def odometry(arguments):
    """Runs the odometry; writes odometry.json."""
    folder = pathlib.Path(arguments.run)
    folder.mkdir(parents=True, exist_ok=True)
    attempts = folder / "attempts"
    with alone(folder / "lock"):
        _odometry(folder, attempts, arguments)


def _odometry(folder, attempts, arguments):
    done = {"name": folder.name, "status": OK, "error": "", "version": provenance.version()}
    try:
        done.update(_run_odometry(folder, arguments))
    except Unusable as error:
        done.update(status=UNUSABLE, error=_relative(str(error), arguments))
    except StepError as error:
        made = int(attempts.read_text() or 0) + 1 if attempts.exists() else 1
        if made <= arguments.retries:
            attempts.write_text(str(made))
            raise
        done.update(status=FAILED, error=_relative(str(error), arguments))
    attempts.unlink(missing_ok=True)
    write_json(arguments.done, done)


def _relative(text, arguments):
    """Without the folders of this machine."""
    for folder in (str(pathlib.Path(arguments.recording).parent), str(pathlib.Path(arguments.run).parent.parent)):
        text = text.replace(folder + "/", "")
    return text


def _run_odometry(folder, arguments):
    recording = pathlib.Path(arguments.recording)
    if (recording / "unusable").is_file():
        raise Unusable((recording / "unusable").read_text().strip())
    truth = pathlib.Path(arguments.truth) if arguments.truth else recording / names.DRIVE_TRUTH
    faults = pathlib.Path(arguments.faults) if arguments.faults else recording / names.DRIVE_FAULTS
    if not recording.exists():
        raise Unusable(f"{recording}: no such recording")
    if not truth.is_file():
        raise Unusable(f"{truth}: no such truth")
    source = "--kitti" if recording.is_dir() else "--bag"
    call([find_tool("offline_odometry"), source, str(recording), "--output", str(folder)] + arguments.options)
    summary = read_json(folder / names.SUMMARY)
    # What the later steps need of the recording, which may be gone by then.
    shutil.copyfile(truth, folder / "truth.txt")
    if faults.is_file():
        shutil.copyfile(faults, folder / "faults.csv")
    else:
        (folder / "faults.csv").unlink(missing_ok=True)
    if (recording / names.DRIVE_TIMES).is_file():
        shutil.copyfile(recording / names.DRIVE_TIMES, folder / "times.txt")
    else:
        (folder / "times.txt").unlink(missing_ok=True)
    if arguments.calib:
        shutil.copyfile(arguments.calib, folder / "calib.txt")
    else:
        (folder / "calib.txt").unlink(missing_ok=True)
    return {"scans": summary[names.RUN][names.SCANS], "dropped": summary[names.DROPPED],
            "identity": identity(folder / "truth.txt"),
            "parameters_sha256": provenance.checksum([folder / names.PARAMETERS])}


def identity(truth):
    """The same for the same drive, whatever it is called: the true trajectory's checksum."""
    return f"{zlib.crc32(truth.read_bytes()):08x}"


def truth_options(folder):
    calib = folder / "calib.txt"
    return ["--ground-truth", str(folder / "truth.txt")] + (["--calib", str(calib)] if calib.exists() else [])


def evaluate(arguments):
    """Judges the run; writes result.json."""
    run, done = pathlib.Path(arguments.run), read_json(arguments.odometry)
    done["judged_version"] = provenance.version()
    folder = pathlib.Path(arguments.done).parent
    with alone(folder / "lock"):
        if done["status"] == OK:
            try:
                done.update(_evaluate(run, folder, arguments))
            except Unusable as error:
                done.update(status=UNUSABLE, error=str(error))
        write_json(arguments.done, done)


def _evaluate(run, folder, arguments):
    folder.mkdir(parents=True, exist_ok=True)
    times = ["--times", str(run / "times.txt")] if (run / "times.txt").exists() else []
    limit = ["--alert-limit", str(arguments.alert_limit)] if arguments.alert_limit else []
    every = ["--episode-every", str(arguments.episode_every)]
    call([find_tool("evaluate_trajectory"), "--estimate", str(run / names.TRAJECTORY_KITTI), "--output", str(folder)] +
         truth_options(run) + times + limit + every)
    command = [find_tool("evaluate_fail_aware"), "--run", str(run), "--output", str(folder), "--keep-episodes",
               "--resamples", str(arguments.resamples)] + truth_options(run) + limit + every
    for file in arguments.parameters:
        command += ["--parameters", file]
    call(command)
    trajectory = read_json(folder / "evaluation.json")
    fail_aware = read_json(folder / names.FAIL_AWARE)[run.name]
    faults_s, (begin_s, end_s) = [], _first_and_last_stamp(run / names.TRAJECTORY_TUM)
    if (run / "faults.csv").exists():
        with open(run / "faults.csv", newline="") as file:
            drive_begin_s = read_json(run / names.SUMMARY)["run"]["drive_begin_stamp_s"]
            faults_s = [drive_begin_s + float(fault[names.FAULT_START]) for fault in csv.DictReader(file)]
    starts = _starts(folder, faults_s)
    return {"parameters_sha256": provenance.checksum([run / names.PARAMETERS] + arguments.parameters),
            "driven_s": end_s - begin_s,
            "trajectory": {key: trajectory[key] for key in (names.PATH_LENGTH, names.SEGMENTS, names.TRANSLATION_ERROR,
                                                            names.ROTATION_ERROR, names.ATE_MAX)},
            "starts": starts,
            "coverage": names.inside(fail_aware, names.COVERAGE),
            "reliability": names.inside(fail_aware, names.RELIABILITY) or []}


def _first_and_last_stamp(path):
    with open(path) as file:
        rows = [line for line in file if line.strip() and not line.startswith("#")]
    return float(rows[0].split()[0]), float(rows[-1].split()[0])


def _starts(folder, faults_s):
    """One dictionary a start: what the alarm and the planner made of it. "apart": it is one of those that share no
    driving with each other: the first one from STARTS_FROM_S on, then each that begins after the failure before it."""
    seconds = planner_figure.read_starts(folder / names.PREDICTIONS)
    starts, first_s, free_from_s = [], None, None
    with open(folder / names.EPISODES, newline="") as file:
        rows = list(csv.DictReader(file))
    for row, (shown_s, of_start) in zip(rows, seconds.items(), strict=True):
        begin_s, time_s, failed = float(row[names.BEGIN]), float(row[names.EPISODE_TIME]), row[names.FAILED] == "1"
        if first_s is None:
            first_s, free_from_s = begin_s, begin_s + STARTS_FROM_S
        apart = begin_s >= free_from_s
        if apart:
            free_from_s = begin_s + time_s if failed else float("inf")
        start = {"begin_s": begin_s, "time_s": time_s, "failed": int(failed), "apart": apart}
        for column in (names.MISSED, names.FALSE_ALARMS):
            start[column] = int(row[column])
        for column in (names.WATCHED, names.ALARM, names.UNKNOWN):
            start[column] = float(row[column])
        start.update(planner_figure.judge(shown_s, of_start, faults_s))
        starts.append(start)
    return starts


def report(arguments):
    """The run's page; for an unusable recording a page that says why."""
    done, page = read_json(arguments.odometry), pathlib.Path(arguments.done)
    page.parent.mkdir(parents=True, exist_ok=True)
    unfinished = page.with_name(f"{page.name}.unfinished_{os.getpid()}")
    if done["status"] == OK:
        run = pathlib.Path(arguments.run)
        command = [sys.executable, "-B", str(SCRIPTS / "report"), str(run), "--output", str(unfinished)] + truth_options(run)
        if (run / "faults.csv").exists():
            command += ["--faults", str(run / "faults.csv")]
        try:
            call(command)
        except Unusable as error:
            done["error"] = str(error)
    if not unfinished.exists():
        unfinished.write_text(f"<!DOCTYPE html><meta charset=utf-8><title>{done['name']}</title><h1>{done['name']}</h1>"
                              f"<p>There is no report: {done['error']}</p>\n")
    os.replace(unfinished, page)


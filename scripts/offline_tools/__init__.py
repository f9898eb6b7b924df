"""The package's tools and states, for the scripts that call and read them."""
import argparse
import math
import os
import pathlib
import shutil
import subprocess
import sys

PACKAGE = "fail_aware_lidar_odometry"
STATES = ["UNKNOWN", "OK", "DEGRADED", "FAILING", "FAILED"]  # by TimeToFailure's numbers
BY_SEVERITY = ["OK", "DEGRADED", "UNKNOWN", "FAILING", "FAILED"]  # as the monitor's hysteresis orders them


def end_of_script(why):
    return SystemExit(f"{os.path.basename(sys.argv[0])}: error: {why}")


def make_empty_folder(path):
    path.mkdir(parents=True, exist_ok=True)
    if any(path.iterdir()):
        raise end_of_script(f"{path} is not empty")


def find_tool(name, failure=end_of_script):
    """Its path: beside the scripts (installed), in the PATH, in this tree's build, in a sourced workspace. Otherwise raises
    failure(why)."""
    scripts = pathlib.Path(__file__).resolve().parent.parent
    sourced = [pathlib.Path(prefix) for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(":") if prefix]
    built = [prefix / "lib" / PACKAGE / name for prefix in [scripts.parent / "build/workspace/devel"] + sourced]
    for candidate in [scripts / name, shutil.which(name)] + built + [scripts.parent / "build/plain/bin" / name]:
        if candidate and os.access(candidate, os.X_OK):
            return str(candidate)
    raise failure(f"{name} not found; build first (scripts/build)")


def output_of(*command, failure=end_of_script, env=None):
    """The standard output of a tool, which find_tool() finds unless its path is given. If the tool ends with an error:
    raises failure(the last line of its errors, which begins with the tool's name)."""
    tool = os.fspath(command[0])
    path = tool if os.sep in tool else find_tool(tool, failure)
    done = subprocess.run([path] + [str(word) for word in command[1:]], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, env=env)
    if done.returncode != 0:
        name, why = os.path.basename(tool), last_line(done.stderr)
        raise failure(why if why.startswith(f"{name}:") else f"{name}: {why}")
    return done.stdout


def within(kind, low, high=math.inf):
    """For argparse's `type`: an int or a float from low to high; the error names the limits."""
    limits = f"a {'whole ' if kind is int else ''}number from {low:g} " + ("on" if high == math.inf else f"to {high:g}")

    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and low <= value <= high):
            raise argparse.ArgumentTypeError(f"'{text}' is not {limits}")
        return value
    return parse


def progress(done, total, what):
    """One line on stderr, drawn over the one before; nothing if stderr is not a terminal."""
    if sys.stderr.isatty():
        print(f"\r{done} of {total} {what}", end="\n" if done >= total else "", file=sys.stderr, flush=True)


def last_line(text):
    lines = text.strip().splitlines()
    return lines[-1] if lines else "no message"

"""The package's offline tools, for the scripts that call them."""
import os
import pathlib
import shutil
import sys

PACKAGE = "fail_aware_lidar_odometry"


def end_of_script(why):
    return SystemExit(f"{os.path.basename(sys.argv[0])}: error: {why}")


def find_tool(name, failure=end_of_script):
    """Its path: beside the scripts (installed), in the PATH, in this tree's build. Otherwise raises failure(why)."""
    scripts = pathlib.Path(__file__).resolve().parent.parent
    for candidate in (scripts / name, shutil.which(name), scripts.parent / "build/workspace/devel/lib" / PACKAGE / name):
        if candidate and os.access(candidate, os.X_OK):
            return str(candidate)
    raise failure(f"{name} not found; build first (scripts/build)")


def last_line(text):
    lines = text.strip().splitlines()
    return lines[-1] if lines else "no message"

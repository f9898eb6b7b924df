"""Checks that a folder holds the files of one finished run of offline_odometry, as its summary.json names them."""
import json
import os
import re
import zlib

from .run import InputError

AGAIN = "; run offline_odometry again"


def _unfinished(folder):
    try:
        names = sorted(os.listdir(folder))
    except OSError as error:
        raise InputError(f"cannot read {folder}: {error.strerror}")
    return [name for name in names if re.fullmatch("unfinished_r[0-9a-f]{16}", name)]


def _mark(path):
    """As summary.json has it. None: there is no such file."""
    size, crc = 0, 0
    try:
        with open(path, "rb") as file:
            for block in iter(lambda: file.read(1 << 20), b""):
                size, crc = size + len(block), zlib.crc32(block, crc)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}")
    return {"bytes": size, "crc32": crc}


def read_summary(folder):
    """summary.json, after a check of all files that it names. Raises InputError, as src/tools/run_folder.hpp does."""
    path = os.path.join(folder, "summary.json")
    unfinished = _unfinished(folder)
    if unfinished:
        raise InputError(f"{os.path.join(folder, unfinished[0])}: a run in this folder did not finish, or is not done yet" + AGAIN
                         + (", or delete that folder to use the results of the run before it" if os.path.exists(path) else ""))
    try:
        with open(path, encoding="utf-8-sig", errors="replace") as file:
            summary = json.load(file)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}: not the folder of a finished run" + AGAIN)
    except ValueError:
        raise InputError(f"{path} is not JSON" + AGAIN)
    if not isinstance(summary, dict):
        raise InputError(f"{path} is not a JSON object" + AGAIN)
    described, files = summary.get("run"), summary.get("files")
    if not isinstance(described, dict) or not isinstance(described.get("id"), str) or not isinstance(files, dict):
        raise InputError(f"{path} names no run (run.id, files): a version that did not check its results wrote it, and its "
                         "files may be those of several runs" + AGAIN)
    for name, expected in files.items():
        found = _mark(os.path.join(folder, name))
        if found is None:
            raise InputError(f"{os.path.join(folder, name)} is missing; run {described['id']} wrote it" + AGAIN)
        if found != expected:
            raise InputError(f"{os.path.join(folder, name)} is not the file that run {described['id']} of summary.json wrote: "
                             "another run's, or changed" + AGAIN)
    return summary

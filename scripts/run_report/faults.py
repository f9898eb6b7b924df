"""The faults that a simulated drive was given."""
import csv

from .run import Fault, InputError

COLUMNS = ("kind", "start_s", "duration_s")


def read(path, begin_s):
    """faults.csv of simulate_drive; its times count from the drive's first sweep, stamped begin_s."""
    try:
        with open(path, newline="", encoding="utf-8-sig", errors="replace") as file:
            rows = list(csv.DictReader(file))
            names = rows[0].keys() if rows else COLUMNS
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}")
    missing = [name for name in COLUMNS if name not in names]
    if missing:
        raise InputError(f"{path}: no column {missing[0]} (wanted: {', '.join(COLUMNS)}, severity)")
    try:
        return [Fault(row["kind"], begin_s + float(row["start_s"]), float(row["duration_s"]), row.get("severity") or "")
                for row in rows]
    except (TypeError, ValueError):
        raise InputError(f"{path}: start_s and duration_s must be numbers")

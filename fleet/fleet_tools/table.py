"""The table of recordings: a CSV file with one recording a row."""
import csv
import pathlib
import re

NEEDED = ("name",)
KNOWN = ("name", "recording", "truth", "calib", "topic", "sensor", "vehicle", "first", "count", "set", "faults", "simulate")
PATHS = ("recording", "truth", "calib", "faults")
TAG = "tag_"
RESERVED = ("pooled",)  # evaluate_fail_aware's name for all runs together


class TableError(Exception):
    pass


class Recording(dict):
    """A row; a missing value is the empty string."""

    def __getattr__(self, column):
        return self[column]

    @property
    def tags(self):
        return {column[len(TAG):]: value for column, value in self.items() if column.startswith(TAG)}


def read(path):
    """{name: Recording} in the table's order. Paths are relative to the table's folder. Raises TableError, one line."""
    path = pathlib.Path(path)
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = csv.DictReader(file)
            columns = list(rows.fieldnames or [])
            _check_columns(path, columns)
            recordings = {}
            for row in rows:
                recording = _recording(row, path, rows.line_num)
                if recording.name in recordings:
                    raise TableError(f"{path}:{rows.line_num}: the name {recording.name} stands twice")
                recordings[recording.name] = recording
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise TableError(f"{path}: {error}")
    if not recordings:
        raise TableError(f"{path}: holds no recording")
    return recordings


def _check_columns(path, columns):
    for column in NEEDED:
        if column not in columns:
            raise TableError(f"{path}: has no column {column}")
    for column in columns:
        if column not in KNOWN and not re.fullmatch(TAG + "[a-z0-9_]+", column or ""):
            raise TableError(f"{path}: unknown column '{column}' (known: {', '.join(KNOWN)}; tags: {TAG}NAME)")


def _recording(row, path, line):
    def fail(why):
        raise TableError(f"{path}:{line}: {why}")

    if None in row or None in row.values():
        fail("has another number of values than the header")
    recording = Recording({column: "" for column in KNOWN})
    recording.update({column: value.strip() for column, value in row.items()})
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", recording.name) or recording.name in RESERVED:
        fail(f"the name '{recording.name}' must be letters, digits, '_', '.', '-'" f" and not {', '.join(RESERVED)}")
    if bool(recording.recording) == bool(recording.simulate):
        fail(f"{recording.name} needs either 'recording' or 'simulate'")
    if recording.recording and not recording.truth:
        fail(f"{recording.name} has no truth")
    for column in ("first", "count"):
        if recording[column] and not recording[column].isdigit():
            fail(f"'{column}' of {recording.name} must be a whole number")
    for column in PATHS + ("sensor", "vehicle"):
        value = recording[column]
        if value and (column in PATHS or value.endswith(".yaml")):
            recording[column] = str((path.parent / value).resolve())
    return recording


def tag_names(recordings):
    return list(next(iter(recordings.values())).tags)


def chosen(recordings, wanted):
    """The names of the recordings that have, of every tag in `wanted` ({tag: value or list}), one of the values.
    Raises TableError for a tag that is no column."""
    for tag in wanted:
        if tag not in tag_names(recordings):
            raise TableError(f"there is no tag '{tag}' (column {TAG}{tag})")
    values = {tag: [str(v) for v in (value if isinstance(value, list) else [value])] for tag, value in wanted.items()}
    return [name for name, recording in recordings.items()
            if all(recording.tags[tag] in of_tag for tag, of_tag in values.items())]

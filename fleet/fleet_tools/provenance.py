"""Which software and which parameters a result comes from."""
import functools
import hashlib
import pathlib
import re
import subprocess

from . import PACKAGE

FITTED_ON = "# fitted on: "  # a line of a yaml file that `calibrate` wrote: name and identity of a recording


@functools.lru_cache(maxsize=None)
def package_version():
    return re.search(r"<version>([^<]+)</version>", (PACKAGE / "package.xml").read_text()).group(1)


@functools.lru_cache(maxsize=None)
def version():
    """The package's version and, in a clone, its commit."""
    try:
        described = subprocess.run(["git", "-C", str(PACKAGE), "describe", "--always", "--dirty", "--abbrev=12"],
                                   capture_output=True, text=True, timeout=60)
        commit = described.stdout.strip() if described.returncode == 0 else ""
    except (OSError, subprocess.SubprocessError):
        commit = ""
    return f"{package_version()} ({commit})" if commit else package_version()


def checksum(paths):
    """SHA-256 over the contents of the files, one after another."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(pathlib.Path(path).read_bytes())
        digest.update(b"\0")
    return digest.hexdigest()


def fitted_on(paths):
    """{identity: name} of the recordings that these parameter files were fitted on."""
    found = {}
    for path in paths:
        for line in pathlib.Path(path).read_text().splitlines():
            if line.startswith(FITTED_ON):
                name, identity = line[len(FITTED_ON):].split()
                found[identity] = name
    return found

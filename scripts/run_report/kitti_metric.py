"""KITTI's translation and rotation error, by the package's own evaluate_trajectory."""
import json
import os
import subprocess
import tempfile

from offline_tools import find_tool


def evaluate(truth, estimate):
    """Poses n x 4 x 4 -> ({"t_err_percent", "r_err_deg_per_m", "lengths_m", ...}, "") or (None, why not)."""
    try:
        tool = find_tool("evaluate_trajectory", LookupError)
    except LookupError:
        return None, "evaluate_trajectory is not built"
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for name, poses in (("truth.txt", truth), ("estimate.txt", estimate)):
            paths.append(os.path.join(folder, name))
            with open(paths[-1], "w", encoding="utf-8") as file:
                file.writelines(" ".join(f"{v:.12g}" for v in T[:3, :].ravel()) + "\n" for T in poses)
        done = subprocess.run([tool, "--ground-truth", paths[0], "--estimate", paths[1]], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, universal_newlines=True)
    if done.returncode != 0:
        return None, (done.stderr.strip().splitlines() or ["evaluate_trajectory failed"])[-1]
    result = json.loads(done.stdout)
    if result.get("t_err_percent") is None:
        return None, "too short a drive"
    return result, ""

#!/usr/bin/python3
"""As minimal.cpp, in Python: reads DIR/velodyne/*.bin (ten a second), prints a line for each sweep. usage: minimal.py DIR

Stamps of KITTI and of simulate_drive mean the middle of a sweep. For KITTI's odometry scans, whose motion is compensated,
add "sensor.timing.source": "none".
"""
import pathlib
import sys

import fail_aware
import numpy


def main(folder):
    scans = sorted(pathlib.Path(folder, "velodyne").glob("*"))
    if not scans:
        sys.exit("minimal: error: no scans in %s/velodyne" % folder)
    odometry = fail_aware.Odometry(profile="default", parameters={"sensor.timing.stamp_reference": "mid"})
    odometry.start_redundant()
    stamp = 0.0
    for path in scans:
        points = numpy.fromfile(path, dtype=numpy.float32).reshape(-1, 4)[:, :3]  # x y z intensity
        result = odometry.step(points, stamp)
        print("%.3f s  x %.3f y %.3f z %.3f m  sigma %.3f %.3f m  %s  %.1f s" % (
            stamp, *result.pose[:3, 3], *result.sigma_xy, result.state, result.time_to_failure))
        stamp += 0.1


if __name__ == "__main__":
    main(sys.argv[1]) if len(sys.argv) == 2 else sys.exit("usage: minimal.py DIR")

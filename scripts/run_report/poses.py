"""Poses as 4x4 matrices T_a_b (points of b to points of a), and the files that carry them."""
import numpy as np

from .run import InputError, Trajectory


def from_quaternion(position, quaternion_xyzw):
    """n x 3 and n x 4 -> n x 4 x 4."""
    q = np.asarray(quaternion_xyzw, float)
    norm = np.linalg.norm(q, axis=1, keepdims=True)
    x, y, z, w = (q / np.where(norm > 0, norm, 1.0)).T
    T = np.tile(np.eye(4), (len(q), 1, 1))
    T[:, 0, 0], T[:, 0, 1], T[:, 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
    T[:, 1, 0], T[:, 1, 1], T[:, 1, 2] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    T[:, 2, 0], T[:, 2, 1], T[:, 2, 2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
    T[:, :3, 3] = position
    return T


def from_xyz_rpy(values):
    x, y, z, roll, pitch, yaw = values
    cr, sr, cp, sp, cy, sy = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    T = np.eye(4)
    T[:3, :3] = [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                 [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                 [-sp, cp * sr, cp * cr]]
    T[:3, 3] = x, y, z
    return T


def yaw(T):
    return np.arctan2(T[..., 1, 0], T[..., 0, 0])


def wrapped(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


def relative_to(T, index):
    return np.linalg.inv(T[index]) @ T


def distance(T):
    """Travelled, from the first pose on, m."""
    steps = np.linalg.norm(np.diff(T[:, :3, 3], axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def move_like_a_camera(T):
    """Along their own z axis more than across it, as KITTI's poses of the camera do."""
    steps = np.einsum("nji,nj->ni", T[:-1, :3, :3], np.diff(T[:, :3, 3], axis=0))
    return np.abs(steps[:, 2]).sum() > np.linalg.norm(steps[:, :2], axis=1).sum()


def at_stamps(trajectory, stamp_s, tolerance_s=0.15):
    """The poses at these stamps, interpolated; and which stamps the trajectory covers."""
    order = np.argsort(trajectory.stamp_s, kind="stable")
    stamps, T = trajectory.stamp_s[order], trajectory.T[order]
    advancing = np.concatenate([[True], np.diff(stamps) > 0])
    stamps, T = stamps[advancing], T[advancing]
    covered = (stamp_s >= stamps[0] - 1e-3) & (stamp_s <= stamps[-1] + 1e-3)
    if len(stamps) == 1:
        return np.tile(T[0], (len(stamp_s), 1, 1)), np.abs(stamp_s - stamps[0]) <= 1e-3
    after = np.clip(np.searchsorted(stamps, stamp_s), 1, len(stamps) - 1)
    gap = stamps[after] - stamps[after - 1]
    share = np.clip((stamp_s - stamps[after - 1]) / gap, 0.0, 1.0)
    exact = (np.abs(stamp_s - stamps[after]) < 1e-6) | (np.abs(stamp_s - stamps[after - 1]) < 1e-6)
    return _between(T[after - 1], T[after], share), covered & (exact | (gap <= tolerance_s))


def _between(T_begin, T_end, share):
    """Straight in position; constant rate about one axis in rotation."""
    T = T_begin.copy()
    T[:, :3, 3] += share[:, None] * (T_end[:, :3, 3] - T_begin[:, :3, 3])
    R = np.swapaxes(T_begin[:, :3, :3], 1, 2) @ T_end[:, :3, :3]
    axis = np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    length = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(length, np.trace(R, axis1=1, axis2=2) - 1.0) * share
    k = axis / np.where(length > 1e-12, length, 1.0)[:, None]
    zero = np.zeros(len(k))
    K = np.stack([np.stack([zero, -k[:, 2], k[:, 1]], 1), np.stack([k[:, 2], zero, -k[:, 0]], 1),
                  np.stack([-k[:, 1], k[:, 0], zero], 1)], 1)
    turn = np.eye(3) + np.sin(angle)[:, None, None] * K + (1 - np.cos(angle))[:, None, None] * (K @ K)
    T[:, :3, :3] = T_begin[:, :3, :3] @ turn
    return T


def read_rows(path, widths):
    """A text file of numbers, every row as long as the first, whose length must be one of `widths`."""
    rows = []
    try:
        with open(path, encoding="utf-8-sig", errors="replace") as file:
            for number, line in enumerate(file, 1):
                if not line.strip() or line.startswith("#"):
                    continue
                try:
                    rows.append([float(cell) for cell in line.replace(",", " ").split()])
                except ValueError:
                    raise InputError(f"{path}: line {number} is not a row of numbers")
                if len(rows[-1]) not in widths or len(rows[-1]) != len(rows[0]):
                    wanted = " or ".join(str(width) for width in widths)
                    raise InputError(f"{path}: line {number} has {len(rows[-1])} numbers instead of {wanted}")
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}")
    if not rows:
        raise InputError(f"{path}: no row of numbers in it")
    rows = np.array(rows)
    if not np.isfinite(rows).all():
        raise InputError(f"{path}: row {int(np.flatnonzero(~np.isfinite(rows).all(axis=1))[0]) + 1} is not finite")
    return rows


def from_kitti_rows(rows):
    T = np.tile(np.eye(4), (len(rows), 1, 1))
    T[:, :3, :] = rows.reshape(-1, 3, 4)
    return T


def from_tum_rows(rows):
    return Trajectory(rows[:, 0], from_quaternion(rows[:, 1:4], rows[:, 4:8]))


def read_lidar_to_camera(path):
    """The line "Tr:" of KITTI's calib.txt."""
    try:
        with open(path, encoding="utf-8-sig", errors="replace") as file:
            for line in file:
                if line.startswith("Tr:") or line.startswith("Tr_velo_to_cam:"):
                    return from_kitti_rows(np.array([[float(cell) for cell in line.split()[1:]]]))[0]
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}")
    except ValueError:
        raise InputError(f"{path}: the line 'Tr:' does not hold 12 numbers")
    raise InputError(f"{path}: no line 'Tr:' in it")

"""What the odometry's published covariance says about the way since t1."""
import numpy as np


def _cross(v):
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def since(T_odom_base, total, index):
    """The covariance of T_start_base about the axes at sweep `index`, from the total one since the first sweep.

    As if what went wrong before `index` and after it were independent: total = J total(index) J^T + R since R^T, what
    there was at `index`, carried along by the lever arm, and what came after it. Solved for `since`; zero before
    `index`. An approximation unless `index` is 0: the drift's biases (core/estimation/drift_model.hpp) are in both, so that it
    is too wide then. n x 4 x 4 and n x 6 x 6 -> n x 6 x 6.
    """
    result = np.zeros_like(total)
    R = np.zeros((6, 6))
    R[:3, :3] = R[3:, 3:] = T_odom_base[index, :3, :3]
    for i in range(index + 1, len(total)):
        J = np.eye(6)
        J[:3, 3:] = -_cross(T_odom_base[i, :3, 3] - T_odom_base[index, :3, 3])
        block = R.T @ (total[i] - J @ total[index] @ J.T) @ R
        result[i] = (block + block.T) / 2
    return result

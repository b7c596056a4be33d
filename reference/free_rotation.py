"""The exact rotation of a free rigid body: Jacobi's elliptic functions for the rates, quadrature for the precession."""

import numpy as np
from scipy.special import ellipj, ellipk, ellipkinc

from drone_engine.arrays import Floats, Integers

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
PIECE = 0.5  # of 1 / speed of the functions' argument, over which one quadrature reaches


def rates(inertia: Floats, rate_b: Floats, t: Floats) -> Floats:
    """Angular velocity in the body frame, (k, 3) rad/s, at times (k,) s after it was (3,); three different moments.

    Landau and Lifshitz, Mechanics, 37; of the ways to name the axes the one is taken in which the third never stops.
    """
    order, handed = _order(inertia, rate_b)
    i1, i2, i3 = inertia[order]
    w = rate_b[order]
    energy2, momentum2 = float((inertia * rate_b**2).sum()), float((inertia**2 * rate_b**2).sum())
    a1 = np.sqrt((energy2 * i3 - momentum2) / (i1 * (i3 - i1)))
    a2 = np.sqrt((energy2 * i3 - momentum2) / (i2 * (i3 - i2)))
    a3 = np.sqrt((momentum2 - energy2 * i1) / (i3 * (i3 - i1)))
    s3 = np.sign(w[2])
    s2 = s3 * handed * np.sign(i3 - i1)
    speed, modulus = _speed(inertia, rate_b)
    start = ellipkinc(np.arctan2(s2 * w[1] / a2, w[0] / a1), modulus)
    sn, cn, dn, _ = ellipj(start + speed * np.asarray(t), modulus)
    found = np.empty((*np.shape(t), 3))
    found[..., order[0]], found[..., order[1]], found[..., order[2]] = a1 * cn, s2 * a2 * sn, s3 * a3 * dn
    return found


def attitude(inertia: Floats, rate_b: Floats, t: float) -> Floats:
    """Rotation matrix (3, 3), body to world, at t s after the two agreed and the body turned at (3,) rad/s."""
    now = rates(inertia, rate_b, np.array([0.0, t]))
    before, after = (_to_momentum(inertia, rate_b, w) for w in now)
    return np.asarray(before.T @ _about_z(_precession(inertia, rate_b, t)) @ after)


def period(inertia: Floats, rate_b: Floats) -> float:
    """Of the rates, s."""
    speed, modulus = _speed(inertia, rate_b)
    return float(4.0 * ellipk(modulus) / speed)


def _order(inertia: Floats, rate_b: Floats) -> tuple[Integers, float]:
    """Indices of the axes 1, 2, 3, and 1 or -1: whether they are right-handed."""
    order = np.argsort(inertia)
    if (inertia**2 * rate_b**2).sum() < (inertia * rate_b**2).sum() * inertia[order[1]]:
        order = order[::-1]
    return order, float(np.linalg.det(np.eye(3)[order]))


def _speed(inertia: Floats, rate_b: Floats) -> tuple[float, float]:
    """Of the functions' argument, 1/s, and their parameter m."""
    i1, i2, i3 = inertia[_order(inertia, rate_b)[0]]
    energy2, momentum2 = float((inertia * rate_b**2).sum()), float((inertia**2 * rate_b**2).sum())
    speed = np.sqrt((i3 - i2) * (momentum2 - energy2 * i1) / (i1 * i2 * i3))
    return float(speed), float((i2 - i1) * (energy2 * i3 - momentum2) / ((i3 - i2) * (momentum2 - energy2 * i1)))


def _to_momentum(inertia: Floats, rate_b: Floats, w: Floats) -> Floats:
    """From the body to a frame whose z is the angular momentum, without the precession: Euler's angles z, x."""
    axes = _axes(inertia, rate_b)
    x, y, z = axes @ (inertia * w) / np.linalg.norm(inertia * w)
    flat = np.hypot(x, y)
    swing = np.array([[y, -x, 0.0], [x, y, 0.0], [0.0, 0.0, flat]]) / flat
    return np.asarray(np.array([[1.0, 0.0, 0.0], [0.0, z, -flat], [0.0, flat, z]]) @ swing @ axes)


def _axes(inertia: Floats, rate_b: Floats) -> Floats:
    """The axes 1, 2, 3 as rows, right-handed."""
    order, handed = _order(inertia, rate_b)
    axes = np.eye(3)[order]
    axes[0] *= handed
    return np.asarray(axes)


def _precession(inertia: Floats, rate_b: Floats, t: float) -> float:
    """How far the body has turned about its angular momentum, rad."""
    first, second, _ = _order(inertia, rate_b)[0]
    pieces = max(1, int(np.ceil(abs(t) * _speed(inertia, rate_b)[0] / PIECE)))
    edges = np.linspace(0.0, t, pieces + 1)
    at = edges[:-1, None] + 0.5 * (NODES + 1.0) * np.diff(edges)[:, None]
    w = rates(inertia, rate_b, at)
    low = inertia[first] * w[..., first] ** 2 + inertia[second] * w[..., second] ** 2
    high = (inertia[first] * w[..., first]) ** 2 + (inertia[second] * w[..., second]) ** 2
    momentum = float(np.linalg.norm(inertia * rate_b))
    return float((0.5 * np.diff(edges)[:, None] * WEIGHTS * momentum * low / high).sum())


def _about_z(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

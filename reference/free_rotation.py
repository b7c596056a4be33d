"""Exact rotation of a free rigid body: Jacobi elliptic functions for the rates, quadrature for the precession."""

import numpy as np
from scipy.special import ellipj, ellipk, ellipkinc

from drone_engine.arrays import Floats, Integers

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
PIECE = 0.5  # change of the functions' argument over one interval of the quadrature


def rates(inertia: Floats, rate_b: Floats, t: Floats) -> Floats:
    """Angular velocity in the body frame, (k, 3) rad/s, at times t (k,) s.

    inertia: three different principal moments, (3,) kg m^2; rate_b: angular velocity at time 0, (3,) rad/s. Formulas:
    Landau and Lifshitz, Mechanics, section 37, with the axes named such that the third component never vanishes.
    """
    order, handedness = _order(inertia, rate_b)
    i1, i2, i3 = inertia[order]
    w = rate_b[order]
    energy2, momentum2 = float((inertia * rate_b**2).sum()), float((inertia**2 * rate_b**2).sum())
    a1 = np.sqrt((energy2 * i3 - momentum2) / (i1 * (i3 - i1)))
    a2 = np.sqrt((energy2 * i3 - momentum2) / (i2 * (i3 - i2)))
    a3 = np.sqrt((momentum2 - energy2 * i1) / (i3 * (i3 - i1)))
    s3 = np.sign(w[2])
    s2 = s3 * handedness * np.sign(i3 - i1)
    speed, modulus = _speed(inertia, rate_b)
    start = ellipkinc(np.arctan2(s2 * w[1] / a2, w[0] / a1), modulus)
    sn, cn, dn, _ = ellipj(start + speed * np.asarray(t), modulus)
    rates_b = np.empty((*np.shape(t), 3))
    rates_b[..., order[0]], rates_b[..., order[1]], rates_b[..., order[2]] = a1 * cn, s2 * a2 * sn, s3 * a3 * dn
    return rates_b


def attitude(inertia: Floats, rate_b: Floats, t: float) -> Floats:
    """Rotation matrix (3, 3), body to world, at time t in s.

    At time 0 it is the identity, and the body rates are `rate_b` (3,) rad/s.
    """
    now = rates(inertia, rate_b, np.array([0.0, t]))
    before, after = (_to_momentum(inertia, rate_b, w) for w in now)
    return np.asarray(before.T @ _about_z(_precession(inertia, rate_b, t)) @ after)


def period(inertia: Floats, rate_b: Floats) -> float:
    """Period of the body rates, s."""
    speed, modulus = _speed(inertia, rate_b)
    return float(4.0 * ellipk(modulus) / speed)


def _order(inertia: Floats, rate_b: Floats) -> tuple[Integers, float]:
    """Indices of the axes 1, 2, 3 of the formulas, and 1 or -1 for a right-handed or left-handed order."""
    order = np.argsort(inertia)
    if (inertia**2 * rate_b**2).sum() < (inertia * rate_b**2).sum() * inertia[order[1]]:
        order = order[::-1]
    return order, float(np.linalg.det(np.eye(3)[order]))


def _speed(inertia: Floats, rate_b: Floats) -> tuple[float, float]:
    """Rate of the argument of the elliptic functions, 1/s, and their parameter m."""
    i1, i2, i3 = inertia[_order(inertia, rate_b)[0]]
    energy2, momentum2 = float((inertia * rate_b**2).sum()), float((inertia**2 * rate_b**2).sum())
    speed = np.sqrt((i3 - i2) * (momentum2 - energy2 * i1) / (i1 * i2 * i3))
    return float(speed), float((i2 - i1) * (energy2 * i3 - momentum2) / ((i3 - i2) * (momentum2 - energy2 * i1)))


def _to_momentum(inertia: Floats, rate_b: Floats, w: Floats) -> Floats:
    """Rotation matrix from the body frame to a frame whose z axis is the angular momentum, without the precession.

    Euler angles about z and x; w: body rates (3,).
    """
    axes = _axes(inertia, rate_b)
    x, y, z = axes @ (inertia * w) / np.linalg.norm(inertia * w)
    flat = np.hypot(x, y)
    rotation = np.array([[y, -x, 0.0], [x, y, 0.0], [0.0, 0.0, flat]]) / flat
    return np.asarray(np.array([[1.0, 0.0, 0.0], [0.0, z, -flat], [0.0, flat, z]]) @ rotation @ axes)


def _axes(inertia: Floats, rate_b: Floats) -> Floats:
    """The axes 1, 2, 3 of the formulas as rows (3, 3), right-handed."""
    order, handedness = _order(inertia, rate_b)
    axes = np.eye(3)[order]
    axes[0] *= handedness
    return np.asarray(axes)


def _precession(inertia: Floats, rate_b: Floats, t: float) -> float:
    """Angle by which the body has precessed about its angular momentum at time t, rad."""
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
    """Rotation matrix about z by an angle in rad."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

"""Exact signs of sums of products of float64 numbers, for predicates that floating point cannot decide.

A sum is kept as one long fixed-point integer that spans all exponents of a product of four numbers, from the smallest
subnormal to the largest number (Kulisch's long accumulator: Kulisch and Miranker 1986, The Arithmetic of the Digital
Computer). So nothing is rounded, overflows or underflows. A determinant takes about a microsecond, hence callers use it
only where their error bounds leave the sign undecided. All numbers must be finite.
"""

import math
from itertools import permutations

import numpy as np

from drone_engine.kernel import allocating, kernel

BITS = 27  # of a digit; sums of four products of digits stay far below 63 bits
MASK = (1 << BITS) - 1
MANTISSA = 2.0**53
LOWEST = 4 * (-1073 - 53)  # exponent of the last bit of the product of four smallest subnormals
# The terms of determinants, as tables for loops: written out, they would make all callers compile much more slowly.
# Columns of ORDERS: the components of u, v and w, and the sign; of MINORS: the points of x, y and z, and the sign.
ORDERS = np.array([(*order, round(np.linalg.det(np.eye(3)[list(order)]))) for order in permutations(range(3))])
MINORS = np.array([(*(three[part] for part in order), sign * parity)
                   for three, sign in (((1, 2, 3), 1), ((0, 2, 3), -1), ((0, 1, 3), 1), ((0, 1, 2), -1))
                   for *order, parity in ORDERS.tolist()])
DIGITS = (4 * 1024 - LOWEST) // BITS + 8  # up to the product of four largest numbers, with room for carries


@allocating
def zeros():
    """An accumulator that holds 0: (DIGITS + 2,) int64, its digits, then the lowest and the highest digit in use."""
    acc = np.zeros(DIGITS + 2, np.int64)
    acc[DIGITS], acc[DIGITS + 1] = DIGITS, 0
    return acc


@kernel
def _digits(a, b):
    """The product of two integers a, b < 2^53 as four digits of BITS bits, the lowest first."""
    a0, a1, b0, b1 = a & MASK, a >> BITS, b & MASK, b >> BITS
    low, middle, high = a0 * b0, a0 * b1 + a1 * b0, a1 * b1
    middle += low >> BITS
    high += middle >> BITS
    return low & MASK, middle & MASK, high & MASK, high >> BITS


@kernel
def add_product(acc, sign, a, b, c, d):
    """Adds sign * a * b * c * d to accumulator acc; sign: 1 or -1."""
    if a == 0.0 or b == 0.0 or c == 0.0 or d == 0.0:
        return
    fa, ea = math.frexp(abs(a))
    fb, eb = math.frexp(abs(b))
    fc, ec = math.frexp(abs(c))
    fd, ed = math.frexp(abs(d))
    x0, x1, x2, x3 = _digits(np.int64(fa * MANTISSA), np.int64(fb * MANTISSA))
    y0, y1, y2, y3 = _digits(np.int64(fc * MANTISSA), np.int64(fd * MANTISSA))
    place = ea + eb + ec + ed - 4 * 53 - LOWEST
    k = place // BITS
    s = place - k * BITS
    up = BITS - s
    x4 = x3 >> up
    x3 = (x3 << s & MASK) | x2 >> up
    x2 = (x2 << s & MASK) | x1 >> up
    x1 = (x1 << s & MASK) | x0 >> up
    x0 = x0 << s & MASK
    if (a < 0.0) ^ (b < 0.0) ^ (c < 0.0) ^ (d < 0.0):
        sign = -sign
    columns = (x0 * y0, x0 * y1 + x1 * y0, x0 * y2 + x1 * y1 + x2 * y0, x0 * y3 + x1 * y2 + x2 * y1 + x3 * y0,
               x1 * y3 + x2 * y2 + x3 * y1 + x4 * y0, x2 * y3 + x3 * y2 + x4 * y1, x3 * y3 + x4 * y2, x4 * y3)
    for i in range(8):
        acc[k + i] += sign * (columns[i] & MASK)
        acc[k + i + 1] += sign * (columns[i] >> BITS)
    acc[DIGITS], acc[DIGITS + 1] = min(acc[DIGITS], k), max(acc[DIGITS + 1], k + 8)


@kernel
def sign(acc):
    """The sign of accumulator acc, -1, 0 or 1; clears the accumulator."""
    carry = np.int64(0)
    rest = np.int64(0)
    for k in range(acc[DIGITS], acc[DIGITS + 1] + 1):
        total = acc[k] + carry
        rest |= total & MASK
        carry = total >> BITS  # rounds down, so the remaining digits are not negative
        acc[k] = 0
    acc[DIGITS], acc[DIGITS + 1] = DIGITS, 0
    if carry != 0:
        return -1 if carry < 0 else 1
    return 1 if rest != 0 else 0


@kernel
def add_determinant(acc, sign, scale, ux, uy, uz, vx, vy, vz, wx, wy, wz):
    """Adds sign * scale * det[u, v, w] to accumulator acc; u, v, w: rows; sign: 1 or -1."""
    u, v, w = (ux, uy, uz), (vx, vy, vz), (wx, wy, wz)
    for i in range(6):
        add_product(acc, sign * ORDERS[i, 3], scale, u[ORDERS[i, 0]], v[ORDERS[i, 1]], w[ORDERS[i, 2]])


@allocating
def orient3d(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """The sign of det[b - a, c - a, d - a]: 1 if a, b, c are counter-clockwise as seen from d, 0 if coplanar."""
    acc = zeros()
    x, y, z = (ax, bx, cx, dx), (ay, by, cy, dy), (az, bz, cz, dz)
    for i in range(24):
        add_product(acc, MINORS[i, 3], 1.0, x[MINORS[i, 0]], y[MINORS[i, 1]], z[MINORS[i, 2]])
    return sign(acc)


@allocating
def orient2d(ax, ay, bx, by, cx, cy):
    """The sign of det[b - a, c - a]: 1 if a, b, c are counter-clockwise, 0 if they are on one line."""
    acc = zeros()
    x, y = (ax, bx, cx), (ay, by, cy)
    for i in range(6):  # x[i] y[k] for i before k in a, b, c, a, and the opposite for i after k
        first, second = (i // 2, (i // 2 + 1) % 3) if i % 2 == 0 else ((i // 2 + 1) % 3, i // 2)
        add_product(acc, 1 - 2 * (i % 2), x[first], y[second], 1.0, 1.0)
    return sign(acc)

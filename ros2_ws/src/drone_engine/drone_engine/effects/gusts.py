"""Dryden gusts, low-altitude model of MIL-F-8785C (3.7.2.1 and 3.7.3.3), independent for each body.

With h the height (ft) and W the wind at 20 ft: L_w = h, L_u = L_v = h / (0.177 + 0.000823 h)^1.2 are the scales of
the turbulence, sigma_w = 0.1 W and sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4 its intensities. White noise
is formed by H_u = sigma sqrt(2 T / pi) / (1 + T s) and H_v,w = sigma sqrt(T / pi) (1 + sqrt(3) T s) / (1 + T s)^2, with
T = L / V and V the body's speed through the air. The discretization of the filters is exact for any step.

The model describes one path and no correlation between paths. Bodies therefore have independent gusts, which is correct
for bodies further apart than L (3 m and more) and wrong for two drones side by side.
"""

import math

import numpy as np
from pydantic import Field

from drone_engine.context import Context, Stages
from drone_engine.effects.noise import normals, streams
from drone_engine.kernel import kernel
from drone_engine.scene.fields import Strict

FOOT = 0.3048  # m
LOWEST, HIGHEST = 10.0, 1000.0  # ft, range of the model; constant beyond
LIGHT = 7.717  # m/s at 20 ft: 15 knots, 'light' in MIL-F-8785C; 30 are moderate, 45 severe
PAIRS = 3  # pairs of normal numbers per step


class Parameters(Strict):
    """Keys of the effect in a scene file."""

    wind_6m: float | None = Field(None, ge=0.0, le=60.0)  # m/s at 20 ft; default: that of the scene's wind, else LIGHT
    ground: float = 0.0  # m, height that heights are measured from


@kernel
def scales(height, wind):
    """L_u = L_v and L_w in m, sigma_u = sigma_v and sigma_w in m/s, at a height in m with a wind in m/s at 20 ft."""
    h = min(max(height / FOOT, LOWEST), HIGHEST)
    base = 0.177 + 0.000823 * h
    sigma = 0.1 * wind
    return FOOT * h / base**1.2, FOOT * h, sigma / base**0.4, sigma


@kernel
def first_order(h):
    """Exact step of length h (in units of T) of the first-order filter with variance 1: the factors of its value and of
    the noise."""
    return math.exp(-h), math.sqrt(-math.expm1(-2.0 * h))


@kernel
def second_order(h):
    """Exact step of length h of the chain a' = -a + n, b' = -b + a: the factor of the values, and the Cholesky factor
    (aa, ab, bb) of the noise's covariance.

    b is white noise through 1 / (1 + T s)^2, a = b + T b'; their covariance is (1, 1/2; 1/2, 1/2) and stays.
    """
    left = math.exp(-h)
    aa = -math.expm1(-2.0 * h)
    if h < 1e-3:  # differences of almost equal numbers
        ab = h * h * (1.0 - 4.0 / 3.0 * h + h * h)
        bb = h * h * h * (2.0 / 3.0 - h + 0.8 * h * h)
    else:
        ab = 0.5 * (1.0 - (1.0 + 2.0 * h) * left * left)
        bb = 0.5 * (1.0 - (1.0 + 2.0 * h + 2.0 * h * h) * left * left)
    root = math.sqrt(aa)
    if root == 0.0:
        return left, 0.0, 0.0, 0.0
    return left, root, ab / root, math.sqrt(max(bb - ab * ab / aa, 0.0))


@kernel
def shape(a, b):
    """Output with unit variance of the filter (1 + sqrt(3) T s) / (1 + T s)^2 from its states a and b."""
    return math.sqrt(0.5) * (b + math.sqrt(3.0) * (a - b))


@kernel
def stir(awake, position, velocity, mean, stream, step, wind, ground, dt, memory, gust):
    """Draws random numbers for each awake body, filters them, and writes its gust (n, 3), m/s.

    memory: (n, 5) states of the filters, in and out: u, a and b of v, a and b of w. u is along the mean wind, w up.
    mean: (n, 3) m/s, or (0, 3) for none; stream: (n,) random streams; step: (1,); wind: m/s at 20 ft; ground: m,
    height that heights are measured from; dt: s.
    """
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        mx = my = mz = 0.0
        if mean.shape[0]:
            mx, my, mz = mean[i, 0], mean[i, 1], mean[i, 2]
        long, short, sigma, sigma_w = scales(position[i, 2] - ground, wind)
        # Turbulence moves past a body with the air; in still air it sweeps itself along (Tennekes 1975).
        speed = math.sqrt((velocity[i, 0] - mx) ** 2 + (velocity[i, 1] - my) ** 2 + (velocity[i, 2] - mz) ** 2)
        path = dt * max(speed, sigma)
        n = PAIRS * (step[0] + 1)
        nu, nv = normals(stream[i], n)
        nw, nx = normals(stream[i], n + 1)
        ny, _ = normals(stream[i], n + 2)
        left, fresh = first_order(path / long)
        memory[i, 0] = left * memory[i, 0] + fresh * nu
        for at, h, first, second in ((1, path / long, nv, nx), (3, path / short, nw, ny)):
            left, aa, ab, bb = second_order(h)
            a, b = memory[i, at], memory[i, at + 1]
            memory[i, at] = left * a + aa * first
            memory[i, at + 1] = left * (b + h * a) + ab * first + bb * second
        u = sigma * memory[i, 0]
        v = sigma * shape(memory[i, 1], memory[i, 2])
        level = math.sqrt(mx * mx + my * my)
        c, s = (mx / level, my / level) if level > 0.0 else (1.0, 0.0)
        gust[i, 0], gust[i, 1] = c * u - s * v, s * u + c * v
        gust[i, 2] = sigma_w * shape(memory[i, 3], memory[i, 4])


@kernel
def blow(awake, gust, air_velocity):
    """Adds gust (n, 3) to air_velocity (n, 3), m/s, of awake bodies."""
    for k in range(1, 1 + awake[0]):
        i = awake[k]
        for c in range(3):
            air_velocity[i, c] += gust[i, c]


def wind_6m(parameters: Parameters, context: Context) -> float:
    """Speed of the wind at 20 ft, m/s."""
    if parameters.wind_6m is not None:
        return parameters.wind_6m
    wind = context.active.get("wind")
    if wind is None:
        return LIGHT
    horizontal = math.hypot(*wind.mean[:2])  # type: ignore[attr-defined]
    return horizontal * float(wind.factor(20.0 * FOOT))  # type: ignore[attr-defined]


def build(parameters: Parameters, context: Context) -> Stages:
    """The stages of this effect."""
    names = context.model.bodies.names
    stream = streams(context.seed, "gusts", names)
    start = np.empty((len(names), 5))
    for i in range(len(names)):  # the stationary distribution, as if the gusts had always blown
        u, a_v = normals(stream[i], 0)
        a_w, b_v = normals(stream[i], 1)
        b_w, _ = normals(stream[i], 2)
        start[i] = u, a_v, 0.5 * (a_v + b_v), a_w, 0.5 * (a_w + b_w)
    memory, gust = context.state.remember("gusts", start), np.zeros((len(names), 3))
    mean = context.forces.air_velocity if "wind" in context.active else np.empty((0, 3))
    return Stages(
        step=(context.stage("gusts", stir, mean=mean, stream=stream, wind=wind_6m(parameters, context),
                            ground=parameters.ground, memory=memory, gust=gust),),
        force=(context.stage("gusts", blow, gust=gust),))

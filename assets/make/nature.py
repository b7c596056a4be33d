"""The island and the sea."""

import numpy as np

from make.shapes import Array, Model, Part, circle, surface

SQUARE = 7.0  # m, radius of the paved square in the middle
PLATEAU = 45.0  # m, how far the flat land reaches at least
SEA = -0.35  # m, height of the water around the island
CURB = 0.35  # m, how wide the stones around the square are
STRIP = 7.0  # m from the coast, where the meadow ends
STEP = 2 * np.pi / 96
ANGLES = np.arange(96, dtype=np.float64) * STEP
PATH_WIDTH = 2.0
KNOLLS = ((-24, -10, 10, 0.70), (-20, 17, 9.5, 0.55), (5, -26, 9, 0.50), (22, 19, 7.5, 0.45))  # x, y, radius, height; m
SWELL = (18.8, 21.5, 24.2, 26.9, 29.6, 32.1)  # m, further rings of the meadow, which are no end of a path
# Headings, as multiples of the step, and how far the paths reach from the middle; None is to the beach.
PATHS = ((24 * STEP, 10.6), (89 * STEP, 15.4), (65 * STEP, 16.6), (5.5 * STEP, 34.5), (51 * STEP, None))


def coast(angle: Array) -> Array:
    """How far the flat land reaches in each direction."""
    bays = 0.50 * np.sin(2 * angle + 0.8) + 0.35 * np.sin(3 * angle + 4.0) + 0.25 * np.sin(5 * angle + 1.0)
    return np.asarray(PLATEAU + 3.0 + 4.5 * bays + 0.9 * np.sin(11 * angle) + 0.5 * np.sin(17 * angle + 2.0))


def island() -> Model:
    """A paved square at z = 0, a meadow with paths and low knolls, a strip where the meadow ends; then a beach, from
    which two rocks reach into the sea. Bodies stand on it, so what looks up has no gaps."""
    edge = coast(ANGLES)
    rings = [_bent(np.full(len(ANGLES), radius)) for radius in (SQUARE + CURB, SQUARE, 0.2 * SQUARE)]
    paving = surface(rings[1:], "cobbles", closed=True, caps=(False, True))
    curb = surface(rings[:2], "stone", closed=True)
    slope = [(0.0, 0.0), (2.5, -0.08), (7.0, -0.40), (16.0, -2.2)]
    beach = surface([_row(edge + out, z) for out, z in slope[::-1]] + [_row(edge - 2.0)], "sand", closed=True)
    rocks = [_headland(7, 153, 46.5, (9.0, 6.5), 1.25), _headland(8, 24, 50.0, (7.0, 5.0), 0.45)]
    return [paving.boxed(), curb.boxed(), *_meadow(edge - STRIP), _shore(edge), beach.boxed(), *rocks]


def _headland(seed: int, heading: float, away: float, size: tuple[float, float], height: float) -> Part:
    """A sheet of rock over the coast, its middle `away` m from the island's in a direction in degrees: nearly flat on
    top, cut by planes around, its rim below the sand. size: m outwards and along the coast."""
    rng = np.random.default_rng(seed)
    count = 26
    rows = []
    for share, rise in ((1.0, -2.0), (0.90, -0.8), (0.80, 0.45), (0.70, 0.80), (0.50, 0.92), (0.25, 1.0)):
        ring = circle(count) * share * rng.uniform(0.93, 1.07, (count, 1)) * size
        z = height * rise if rise > 0 else rise
        rows.append(np.column_stack([ring, z + min(share, 0.8) * rng.uniform(-0.12, 0.12, count)]))
    sheet = surface(rows, "rock", closed=True, caps=(False, True), crease=0.45)
    turn = np.radians(heading)
    return sheet.moved((away * np.cos(turn), away * np.sin(turn), 0), yaw=turn).boxed()


def knolls(x: Array, y: Array) -> Array:
    """How high the meadow is, m."""
    far = [((x - cx) ** 2 + (y - cy) ** 2) / radius**2 for cx, cy, radius, _ in KNOLLS]
    return np.asarray(sum(high * np.maximum(1 - d, 0.0) ** 2 for d, (*_, high) in zip(far, KNOLLS, strict=True)))


def _row(radius: float | Array, z: float = 0.0) -> Array:
    """Points around the middle."""
    return np.column_stack([circle(len(ANGLES)) * np.reshape(radius, (-1, 1)), np.full(len(ANGLES), z)])


def _meadow(end: Array) -> Model:
    """Grass from the curb to `end`, cut by paths: straight, equally wide, each from the square to its own end."""
    stops = sorted({*SWELL, *(reach for _, reach in PATHS if reach is not None)})
    start = SQUARE + CURB
    radii = [np.full(len(ANGLES), radius) for radius in (start, *stops)] + [end]
    rows = np.array([_bent(radius) for radius in radii])
    parts: Model = []
    covered = np.zeros((len(radii) - 1, len(ANGLES)), dtype=bool)
    for heading, reach in PATHS:
        middle = round(heading / STEP) % len(ANGLES)
        count = len(stops) + 1 if reach is None else stops.index(reach) + 1
        columns = [middle - 1, middle, (middle + 1) % len(ANGLES)]
        covered[:count, columns[:2]] = True
        far = radii_of(rows[: count + 1, middle])[:, None] / 2.5
        uv = np.dstack(np.broadcast_arrays(np.array([0.0, 0.5, 1.0]), far))
        parts.append(surface(rows[: count + 1, columns][::-1], "path", uv=uv[::-1]))
    sheet = surface(rows[::-1], "grass", closed=True)
    free = np.repeat(~covered[::-1].ravel(), 2)
    return [*parts, Part(sheet.corners[free], sheet.uv[free], "grass").boxed()]


def radii_of(points: Array) -> Array:
    """Distances from the middle, in the plane."""
    return np.asarray(np.hypot(points[..., 0], points[..., 1]))


def _bent(radius: Array) -> Array:
    """A row of the meadow whose points next to a path stand at the path's edges."""
    angle = ANGLES.copy()
    for heading, _ in PATHS:
        middle = round(heading / STEP) % len(ANGLES)
        half = np.arcsin(PATH_WIDTH / 2 / radius[middle])
        for side in (-1, 1):
            near = [(middle + side * k) % len(ANGLES) for k in range(5)]
            angle[near] = heading + side * np.interp(np.arange(5), [0, 1, 4], [0.0, half, 4 * STEP])
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    return np.column_stack([x, y, knolls(x, y)])


def _shore(edge: Array) -> Part:
    """The strip from meadow to beach; its texture runs around the island a whole number of times."""
    part = surface([_row(edge - 2.0), _bent(edge - STRIP)], "shore", closed=True)
    turn = np.arctan2(part.corners[..., 1], part.corners[..., 0]) % (2 * np.pi)
    turn = np.where((turn < 1.0) & (turn.max(axis=1, keepdims=True) > 5.0), turn + 2 * np.pi, turn)
    outer = radii_of(part.corners) > coast(turn) - STRIP / 2 - 1.0
    around = np.round(2 * np.pi * PLATEAU / 5.0) * 5.0
    return Part(part.corners, np.stack([turn / (2 * np.pi) * around, np.where(outer, 0.5, 4.5)], axis=-1), "shore")


def water() -> Model:
    """A disk of 900 m; the shader makes the waves."""
    count = 32
    rows = [np.column_stack([circle(count) * radius, np.zeros(count)]) for radius in (900.0, 350.0, 140.0, 60.0)]
    return [surface(rows, "water", closed=True, caps=(False, True)).boxed()]


MODELS = {
    "island": island,
    "water": water,
}

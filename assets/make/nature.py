"""The island, the sea, trees and rocks."""

import numpy as np

from make.shapes import Array, Model, Part, ball, circle, surface, tube

SQUARE = 7.0  # m, radius of the paved square in the middle
PLATEAU = 45.0  # m, how far the flat land reaches at least
SEA = -0.35  # m, height of the water
CURB = 0.35  # m, how wide the stones around the square are
STRIP = 7.0  # m from the coast, where the meadow ends
STEP = 2 * np.pi / 96
ANGLES = np.arange(96, dtype=np.float64) * STEP
PATH_WIDTH = 2.0
# Headings, as multiples of the step, and how far the paths reach from the middle; None is to the beach.
PATHS = ((24 * STEP, 10.6), (89 * STEP, 15.4), (65 * STEP, 16.6), (5.5 * STEP, 34.5), (51 * STEP, None))


def coast(angle: Array) -> Array:
    """How far the flat land reaches in each direction."""
    bays = 0.50 * np.sin(2 * angle + 0.8) + 0.35 * np.sin(3 * angle + 4.0) + 0.25 * np.sin(5 * angle + 1.0)
    return np.asarray(PLATEAU + 3.0 + 4.5 * bays + 0.9 * np.sin(11 * angle) + 0.5 * np.sin(17 * angle + 2.0))


def island() -> Model:
    """Flat land at z = 0: a paved square, a meadow with paths, a strip where the meadow ends; then a beach."""
    edge = coast(ANGLES)
    rings = [_bent(np.full(len(ANGLES), radius)) for radius in (SQUARE + CURB, SQUARE, 0.2 * SQUARE)]
    paving = surface(rings[1:], "cobbles", closed=True, caps=(False, True))
    curb = surface(rings[:2], "stone", closed=True)
    slope = [(0.0, 0.0), (2.5, -0.08), (7.0, -0.40), (16.0, -2.2)]
    beach = surface([_row(edge + out, z) for out, z in slope[::-1]] + [_row(edge - 2.0)], "sand", closed=True)
    return [paving.boxed(), curb.boxed(), *_meadow(edge - STRIP), _shore(edge), beach.boxed()]


def _row(radius: float | Array, z: float = 0.0) -> Array:
    """Points around the middle."""
    return np.column_stack([circle(len(ANGLES)) * np.reshape(radius, (-1, 1)), np.full(len(ANGLES), z)])


def _meadow(end: Array) -> Model:
    """Grass from the curb to `end`, cut by paths: straight, equally wide, each from the square to its own end."""
    stops = sorted({reach for _, reach in PATHS if reach is not None})
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
    for ring in range(len(radii) - 1):
        sheet = surface(rows[ring : ring + 2][::-1], "grass", closed=True)
        free = np.repeat(~covered[ring], 2)
        parts.append(Part(sheet.corners[free], sheet.uv[free], "grass").boxed())
    return parts


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
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(len(ANGLES))])


def _shore(edge: Array) -> Part:
    """The strip from meadow to beach; its texture runs around the island a whole number of times."""
    part = surface([_row(edge - 2.0), _bent(edge - STRIP)], "shore", closed=True)
    turn = np.arctan2(part.corners[..., 1], part.corners[..., 0]) % (2 * np.pi)
    turn = np.where((turn < 1.0) & (turn.max(axis=1, keepdims=True) > 5.0), turn + 2 * np.pi, turn)
    outer = radii_of(part.corners) > coast(turn) - STRIP / 2 - 1.0
    around = np.round(2 * np.pi * PLATEAU / 5.0) * 5.0
    return Part(part.corners, np.stack([turn / (2 * np.pi) * around, np.where(outer, 0.5, 4.5)], axis=-1), "shore")


def water() -> Model:
    """A disk of 900 m at the height of the sea; the shader makes the waves."""
    count = 32
    rows = [np.column_stack([circle(count) * radius, np.full(count, SEA)]) for radius in (900.0, 350.0, 140.0, 60.0)]
    return [surface(rows, "water", closed=True, caps=(False, True)).boxed()]


def palm(seed: int) -> Model:
    """A bent trunk, two tiers of fronds and a few nuts."""
    rng = np.random.default_rng(seed)
    height = 4.6
    rise = np.linspace(0, 1, 5)
    path = np.column_stack([0.55 * rise**2 - 0.25, 0.12 * np.sin(2.5 * rise), height * rise])
    radius = 0.17 - 0.07 * rise + 0.05 * (1 - rise) ** 6
    top = path[-1]
    model: Model = [tube(path, radius, "palm_bark", 6, caps=(False, False))]
    for tier, (count, droop, length) in enumerate(((6, 1.05, 1.75), (5, 0.45, 1.45))):
        for leaf in range(count):
            yaw = 2 * np.pi * (leaf + 0.5 * tier + rng.uniform(-0.15, 0.15)) / count
            model.append(_frond(length * rng.uniform(0.92, 1.08), droop + rng.uniform(-0.1, 0.1)).moved(top, yaw=yaw))
    model += [
        ball((0.10, 0.10, 0.12), top + np.array([0.14 * np.cos(a), 0.14 * np.sin(a), -0.12]), "coconut", 5, 3)
        for a in (0.5, 3.4)
    ]
    return model


def _frond(length: float, droop: float) -> Part:
    """A leaf along +x that rises and then bends down, folded along its rib, seen from both sides."""
    along = np.linspace(0, 1, 4)
    angle = 0.75 - (0.75 + droop) * along**0.8
    steps = np.diff(along, prepend=0)[:, None] * length
    rib = np.cumsum(np.column_stack([np.cos(angle), np.zeros(4), np.sin(angle)]) * steps, axis=0)
    width = np.array([0.05, 0.27, 0.25, 0.01])
    rows = np.array(
        [rib + np.column_stack([np.zeros(4), side * width, -0.55 * width * abs(side)]) for side in (-1, 0, 1)]
    ).swapaxes(0, 1)
    uv = np.dstack(np.broadcast_arrays(along[:, None], np.array([0.0, 0.5, 1.0])))
    upper, lower = (surface(rows[:, way], "frond", uv=uv[:, way]) for way in (slice(None), slice(None, None, -1)))
    return Part(np.concatenate([upper.corners, lower.corners]), np.concatenate([upper.uv, lower.uv]), "frond", 1.0)


def pine(seed: int) -> Model:
    """A straight trunk and five skirts of needles, ragged at the hem."""
    rng = np.random.default_rng(seed)
    model: Model = [tube([(0, 0, 0), (0, 0, 0.25), (0, 0, 1.2)], [0.24, 0.16, 0.13], "bark", 7, caps=(False, False))]
    count = 10
    for tier in range(5):
        low, radius, rise = 0.9 + 0.92 * tier, 1.45 - 0.25 * tier, 1.75 - 0.15 * tier
        ragged = np.where(np.arange(count) % 2, 1.0, 0.80) * rng.uniform(0.92, 1.08, count)
        ring = circle(count) @ np.array([[np.cos(tier), np.sin(tier)], [-np.sin(tier), np.cos(tier)]])
        hem = np.column_stack([ring * (radius * ragged)[:, None], low - 0.12 * np.where(np.arange(count) % 2, 1, 0)])
        inner = np.column_stack([ring * 0.12, np.full(count, low + 0.25)])
        tip = np.tile([rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03), low + rise], (count, 1))
        model.append(surface([inner, hem, tip], "needles", closed=True, crease=0.9))
    return model


def bush(seed: int) -> Model:
    """Three round heaps of leaves with a few blossoms."""
    rng = np.random.default_rng(seed)
    model = [
        _lump(rng, size, 8, 5, "foliage", 0.10).moved(at)
        for size, at in (
            ((0.55, 0.50, 0.48), (0, 0, 0.40)),
            ((0.40, 0.42, 0.36), (0.42, 0.18, 0.33)),
            ((0.38, 0.36, 0.34), (-0.30, -0.34, 0.32)),
        )
    ]
    for _ in range(6):
        angle, up = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 0.85)
        out = np.sqrt(1 - up**2)
        at = (0.54 * out * np.cos(angle), 0.50 * out * np.sin(angle), 0.40 + 0.49 * up)
        model.append(ball((0.05, 0.05, 0.04), at, "flower_red", 4, 3))
    return model


def rock(seed: int, size: tuple[float, float, float]) -> Model:
    """A boulder with flats, sunk a little into the ground."""
    rng = np.random.default_rng(seed)
    stone = _lump(rng, size, 12, 8, "rock", 0.16, flats=9)
    corners = stone.corners + np.array([0, 0, 0.62 * size[2]])
    corners[..., 2] = np.maximum(corners[..., 2], 0.0)
    solid = np.ptp(corners[..., 2], axis=1) > 1e-6
    return [Part(corners[solid], stone.uv[solid], "rock", 0.55).boxed()]


def _lump(
    rng: np.random.Generator,
    size: tuple[float, float, float],
    segments: int,
    rings: int,
    material: str,
    rough: float,
    flats: int = 0,
) -> Part:
    """A ball with dents, cut by a few planes."""
    part = ball((1, 1, 1), (0, 0, 0), material, segments, rings)
    points, index = np.unique(np.round(part.corners.reshape(-1, 3), 6), axis=0, return_inverse=True)
    points = points * rng.uniform(1 - rough, 1 + rough, (len(points), 1))
    for normal in rng.normal(size=(flats, 3)):
        normal = normal / np.linalg.norm(normal)
        points = points - np.maximum(points @ normal - rng.uniform(0.62, 0.85), 0)[:, None] * normal
    corners = (points * size)[index.ravel()].reshape(-1, 3, 3)
    return Part(corners, part.uv, material, 0.9).boxed()


MODELS = {
    "island": island,
    "water": water,
    "palm": lambda: palm(1),
    "pine": lambda: pine(2),
    "bush": lambda: bush(3),
    "rock_round": lambda: rock(4, (0.9, 0.8, 0.65)),
    "rock_flat": lambda: rock(5, (1.7, 1.1, 0.55)),
    "rock_tall": lambda: rock(6, (1.4, 1.2, 2.4)),
}

"""Trees, bushes and rocks."""

import numpy as np

from make.shapes import Array, Model, Part, ball, circle, surface, tube

THIN = 0.006  # m, of a leaflet: what has no thickness at all, levels of detail may leave out


def palm(seed: int) -> Model:
    """A bent trunk, two tiers of feathered fronds and a few nuts."""
    rng = np.random.default_rng(seed)
    height = 4.6
    rise = np.linspace(0, 1, 5)
    path = np.column_stack([0.55 * rise**2 - 0.25, 0.12 * np.sin(2.5 * rise), height * rise])
    radius = 0.17 - 0.07 * rise + 0.05 * (1 - rise) ** 6
    top = path[-1]
    model: Model = [tube(path, radius, "palm_bark", 6, caps=(False, False))]
    for tier, (count, droop, length, pairs) in enumerate(((6, 1.15, 1.75, 9), (5, 0.60, 1.50, 8))):
        for leaf in range(count):
            yaw = 2 * np.pi * (leaf + 0.5 * tier + rng.uniform(-0.15, 0.15)) / count
            frond = _frond(rng, length * rng.uniform(0.92, 1.08), droop + rng.uniform(-0.15, 0.15), pairs)
            model.append(frond.moved(top, yaw=yaw))
    model += [
        ball((0.10, 0.10, 0.12), top + np.array([0.14 * np.cos(a), 0.14 * np.sin(a), -0.12]), "coconut", 5, 3)
        for a in (0.5, 3.4)
    ]
    return model


def _frond(rng: np.random.Generator, length: float, droop: float, pairs: int) -> Part:
    """A rib along +x that rises and bends down, with pointed leaflets that hang to both sides, seen from both faces."""
    along = np.linspace(0, 1, pairs + 1)
    angle = 0.85 - (0.85 + droop) * along**0.9
    steps = np.diff(along, prepend=0)[:, None] * length
    rib = np.cumsum(np.column_stack([np.cos(angle), np.zeros(pairs + 1), np.sin(angle)]) * steps, axis=0)
    reach = 0.46 * length / 1.75 * np.interp(along[:-1], [0.0, 0.12, 0.4, 1.0], [0.35, 0.75, 1.0, 0.42])
    triangles, uv = [], []
    for i in range(pairs):
        base, ahead = rib[i], rib[i + 1]
        forward = (ahead - base) / np.linalg.norm(ahead - base)
        for side in (1.0, -1.0):
            size = reach[i] * rng.uniform(0.88, 1.12)
            tip = ahead + size * (0.55 * forward + np.array([0.0, 0.80 * side, -0.42 - 0.25 * along[i]]))
            upper = np.array([base, ahead, tip]) - [0, 0, 0.012 * (i % 2)]
            green, pale = (np.array([(0.03, v + 0.02), (0.03, v + 0.48), (0.97, v + 0.25)]) for v in (0.0, 0.5))
            for shape, place in ((upper, green), ((upper - np.array([0, 0, THIN]))[::-1], pale[::-1])):
                triangles.append(shape if side > 0 else shape[::-1])
                uv.append(place if side > 0 else place[::-1])
    return Part(np.array(triangles), np.array(uv), "frond", 1.0)


def pine(seed: int) -> Model:
    """A straight trunk and seven uneven skirts of needles, ragged at the hem."""
    rng = np.random.default_rng(seed)
    model: Model = [tube([(0, 0, 0), (0, 0, 0.25), (0, 0, 1.2)], [0.24, 0.16, 0.13], "bark", 7, caps=(False, False))]
    count, tiers = 10, 7
    for tier in range(tiers):
        part = tier / (tiers - 1)
        low = 0.80 + 3.95 * part**0.96 + rng.uniform(-0.06, 0.06)
        radius, rise = 1.48 - 1.10 * part, 1.55 - 0.55 * part
        even = np.arange(count) % 2 == 0
        ragged = np.where(even, 1.0, 0.70) * rng.uniform(0.84, 1.10, count)
        turn = 1.9 * tier
        ring = circle(count) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        lean = rng.uniform(-0.05, 0.05, 2)
        sag = low - 0.22 * ragged * even - rng.uniform(0.0, 0.12, count)
        hem = np.column_stack([ring * (radius * ragged)[:, None] + lean, sag])
        inner = np.column_stack([ring * 0.10, np.full(count, low + 0.30)])
        tip = np.tile([*(lean * 0.5), low + rise], (count, 1))
        skirt = surface([inner, hem, tip], "needles", closed=True, crease=0.7)
        model.append(Part(skirt.corners, _hanging(skirt.corners, turn), "needles", skirt.crease))
    return model


def _hanging(corners: Array, turn: float) -> Array:
    """Texture coordinates around the trunk and along the slope, so that twigs hang outwards and down."""
    middle = corners.mean(axis=1)
    heading = np.arctan2(middle[:, 1], middle[:, 0])[:, None] + turn
    away = np.arctan2(corners[..., 1], corners[..., 0]) + turn
    bend = (away - heading + np.pi) % (2 * np.pi) - np.pi
    out = np.hypot(corners[..., 0], corners[..., 1])
    down = np.hypot(out, corners[..., 2].max() - corners[..., 2])
    return np.stack([0.62 * (heading + np.where(out > 0.15, bend, 0.0)), -down], axis=-1)


def bush(seed: int) -> Model:
    """Three round heaps of leaves with a few blossoms."""
    rng = np.random.default_rng(seed)
    model = [
        _lump(rng, size, 9, 6, "foliage", 0.13).moved(at)
        for size, at in (
            ((0.55, 0.50, 0.48), (0, 0, 0.40)),
            ((0.40, 0.42, 0.36), (0.42, 0.18, 0.30)),
            ((0.38, 0.36, 0.34), (-0.30, -0.34, 0.29)),
        )
    ]
    for _ in range(6):
        angle, up = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 0.85)
        out = np.sqrt(1 - up**2)
        at = (0.54 * out * np.cos(angle), 0.50 * out * np.sin(angle), 0.40 + 0.49 * up)
        model.append(ball((0.05, 0.05, 0.04), at, "flower_red", 4, 3))
    return model


def rock(seed: int, size: tuple[float, float, float]) -> Model:
    """A boulder with flats, sunk into the ground so far that it widens down to it."""
    rng = np.random.default_rng(seed)
    stone = _lump(rng, size, 14, 9, "rock", 0.10, flats=8)
    corners = stone.corners + np.array([0, 0, 0.10 * size[2]])
    low = np.clip(-corners[..., 2:] / size[2], 0, 1)
    corners[..., :2] *= 1 + 0.5 * low
    corners[..., 2] = np.maximum(corners[..., 2], 0.0)
    solid = np.ptp(corners[..., 2], axis=1) > 1e-6
    return [Part(corners[solid], stone.uv[solid], "rock", 0.75).boxed()]


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
        points = points - np.maximum(points @ normal - rng.uniform(0.66, 0.88), 0)[:, None] * normal
    corners = (points * size)[index.ravel()].reshape(-1, 3, 3)
    return Part(corners, part.uv, material, 0.9).boxed()


MODELS = {
    "palm": lambda: palm(1),
    "pine": lambda: pine(2),
    "bush": lambda: bush(3),
    "rock_round": lambda: rock(22, (0.84, 0.75, 0.88)),
    "rock_flat": lambda: rock(42, (1.55, 1.0, 0.72)),
    "rock_tall": lambda: rock(63, (1.4, 1.2, 3.5)),
}

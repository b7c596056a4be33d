"""A drone flies through a ring, an archway and under a table where its level knows openings; bounds stop it."""


import pytest

from drone_engine import load
from drone_engine.assets import ASSETS
from drone_engine.scene.schema import Collision
from drone_engine.world import World

SCENE = ASSETS / "scenes" / "ring.yaml"
FLIGHT = ((4.9, 2.0, 0.0), (1.0, 2.0, -0.6), (1.4, 2.0, 0.0))  # for s: forward and up in m/s


def flown(level: str) -> tuple[World, set[str]]:
    """The world after the flight, and what the drone has touched."""
    scene = load(SCENE)
    world = World(scene.model_copy(update={"collision": Collision.model_validate({"level": level})}))
    names, touched = world.model.bodies.names, set()
    for duration, forward, up in FLIGHT:
        for _ in range(round(duration / world.dt)):
            world.step({"user_drone": (forward, 0.0, up, 0.0)})
            touched |= {names[i] for event in world.events for i in (event.a, event.b)}
    return world, touched - {"user_drone"}


@pytest.mark.parametrize("level", ["octree", "triangle"])
def test_openings_are_open(level: str) -> None:
    world, touched = flown(level)
    assert world.pose("user_drone")[0] > 13.0
    assert touched == set()


@pytest.mark.parametrize("level", ["sphere", "obb"])
def test_bounds_are_closed(level: str) -> None:
    world, touched = flown(level)
    assert world.pose("user_drone")[0] < 4.0
    assert touched == {"ring"}

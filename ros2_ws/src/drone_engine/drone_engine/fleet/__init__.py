"""Many copies of one scene, for Monte Carlo: with different initial states, commands and seeds.

    fleet = Fleet(load("my_scene.yaml"), 1000)
    fleet.state.velocity_w[:] = random.normal(size=(1000, 3))
    fleet.run(240, commands=(1.0, 0.0, 0.0, 0.0))
    print(fleet.state.position_w.std(axis=0))
"""

from drone_engine.fleet.fleet import Fleet
from drone_engine.fleet.state import FleetState

__all__ = ["Fleet", "FleetState"]

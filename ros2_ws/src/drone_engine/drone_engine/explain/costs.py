"""Cost of the stages of a scene, measured in the compiled loop, and the kernels compiled for them."""

import statistics
import time
from typing import NamedTuple

from drone_engine.kernel import reached
from drone_engine.program.stage import Stage
from drone_engine.scene.schema import Scene
from drone_engine.world import World

BATCHES = 41
BATCH = 0.01  # s of wall time
WARM_UP = 30  # steps


class Cost(NamedTuple):
    """Cost of a stage."""

    stage: str
    kernel: str  # '' if it runs in Python
    us: float  # per step


class Costs(NamedTuple):
    """Medians over batches of steps from the start of the scene, without commands."""

    stages: list[Cost]
    step_us: float  # CPU time, without clock readings between stages
    real_time_factor: float
    kernels: dict[str, list[str]]  # names of all kernels compiled for the stages, by module


def measure(scene: Scene) -> Costs:
    """Runs two new worlds of the scene, one with clock readings between the stages and one without."""
    timed, plain = World(scene, timed=True), World(scene)
    timed.compile()
    plain.compile()
    plain.run(WARM_UP)
    steps = _steps_of_a_batch(plain)
    samples: list[dict[str, float]] = []
    timed.run(WARM_UP)
    timed.stage_times()
    spent = []
    for _ in range(BATCHES):
        timed.run(steps)
        samples.append(timed.stage_times())
        before = time.thread_time()
        plain.run(steps)
        spent.append((time.thread_time() - before) / steps)
    kernels = {name: stage.kernel for name, stage in _stages(plain).items()}
    step = statistics.median(spent)
    return Costs(
        stages=[Cost(name, _name(kernels[name]), statistics.median(sample[name] for sample in samples))
                for name in plain.stage_names()],
        step_us=1e6 * step, real_time_factor=plain.dt / step, kernels=compiled(plain))


def _steps_of_a_batch(world: World) -> int:
    before = time.perf_counter()
    world.run(WARM_UP)
    return max(1, round(BATCH * WARM_UP / (time.perf_counter() - before)))


def _stages(world: World) -> dict[str, Stage]:
    """The stages by their names in reports."""
    inner = (*world.force_program.stages, *world.substep_program.stages)
    return {f"motion: {stage.name}": stage for stage in inner} | {stage.name: stage for stage in world.program.stages}


def _name(kernel: object) -> str:
    function = getattr(kernel, "py_func", None)
    return f"{function.__module__.removeprefix('drone_engine.')}.{function.__name__}" if function else ""


def compiled(world: World) -> dict[str, list[str]]:
    """Names of the kernels of a world's stages and of all kernels that they call, by module."""
    names = {_name(kernel) for stage in _stages(world).values() if stage.kernel for kernel in reached(stage.kernel)}
    modules: dict[str, list[str]] = {}
    for module, function in sorted(name.rsplit(".", 1) for name in names):
        modules.setdefault(module, []).append(function)
    return modules

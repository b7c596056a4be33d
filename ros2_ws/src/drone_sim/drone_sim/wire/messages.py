"""Low-rate messages of the simulation: the scene and diagnostics."""

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from drone_interfaces.msg import Scene as SceneMessage
from std_msgs.msg import Header

from drone_engine.world import World
from drone_sim.wire.cdr import SECOND

KEEPING_UP = 0.95  # share of the requested rate below which the diagnostics warn


def time_message(time_ns: int) -> Time:
    """A time in ns as builtin_interfaces/Time."""
    return Time(sec=time_ns // SECOND, nanosec=time_ns % SECOND)


def scene_message(world: World) -> SceneMessage:
    """The description of a running world."""
    scene = world.scene
    return SceneMessage(
        name=scene.name, uri=str(scene.path), hash=scene.hash, physics_rate=scene.rates.physics,
        draw_rate=scene.rates.draw, seed=scene.seed, collision_level=scene.collision.level,
        effects=world.stage_names(), render=scene.render.features(),
        objects=list(scene.objects), cameras=list(scene.cameras))


def diagnostics(world: World, time_ns: int, *, rate: float, asked: float, rejected: int, lag: float,
                publishing_us: float) -> DiagnosticArray:
    """The diagnostics of a world at a simulated time in ns.

    rate, asked: steps per s of wall time, measured and requested (0: unlimited). rejected: commands so far.
    lag: s of wall time dropped so far. publishing_us: µs of publishing per step.
    """
    late = asked > 0.0 and rate < KEEPING_UP * asked
    status = DiagnosticStatus(
        level=DiagnosticStatus.WARN if late else DiagnosticStatus.OK,
        name="drone_sim: physics",
        message=f"{rate:.1f} of {asked:.1f} steps per s" if asked else f"{rate:.1f} steps per s",
        hardware_id=world.scene.name,
        values=[
            KeyValue(key="steps per s", value=f"{rate:.2f}"),
            KeyValue(key="lag given up, s", value=f"{lag:.3f}"),
            KeyValue(key="commands rejected", value=str(rejected)),
            *(KeyValue(key=f"contacts at level {level}", value=str(count))
              for level, count in world.contact_counts().items()),
            *(KeyValue(key=f"{name}, us per step", value=f"{us:.1f}") for name, us in world.stage_times().items()),
            KeyValue(key="publishing, us per step", value=f"{publishing_us:.1f}"),
        ])
    return DiagnosticArray(header=Header(stamp=time_message(time_ns)), status=[status])

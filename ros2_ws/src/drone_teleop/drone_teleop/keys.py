"""The meaning of keys: the table of teleop_twist_keyboard, a few more keys, and when a key counts as held.

Independent of ROS and of terminals; times are in s of any monotonic clock.
"""

from enum import Enum
from math import inf

Velocity = tuple[float, float, float, float]  # x forward, y left, z up in m/s; yaw rate in rad/s

HELP = """\
Keys set the velocity of the drone. This works best with a US keyboard layout.
---------------------------
Moving around:
   u    i    o
   j    k    l
   m    ,    .

For Holonomic mode (strafing), hold down the shift key:
---------------------------
   U    I    O
   J    K    L
   M    <    >

t : up (+z)
b : down (-z)

anything else : stop

q/z : increase/decrease max speeds by 10%
w/x : increase/decrease only linear speed by 10%
e/c : increase/decrease only angular speed by 10%

F4 (hold) : the AI drone lands and stays down
Tab       : next camera
F2 or p   : save an image
F3 or v   : show or hide the debug view of collisions
[ or ]    : show fewer or more levels of its octrees
Space     : pause, continue
r         : reset the simulation

CTRL-C to quit
"""

MOVES: dict[str, tuple[int, int, int, int]] = {  # key: signs of the velocity along x, y, z and of the yaw rate
    "i": (1, 0, 0, 0),
    "o": (1, 0, 0, -1),
    "j": (0, 0, 0, 1),
    "l": (0, 0, 0, -1),
    "u": (1, 0, 0, 1),
    ",": (-1, 0, 0, 0),
    ".": (-1, 0, 0, 1),
    "m": (-1, 0, 0, -1),
    "O": (1, -1, 0, 0),
    "I": (1, 0, 0, 0),
    "J": (0, 1, 0, 0),
    "L": (0, -1, 0, 0),
    "U": (1, 1, 0, 0),
    "<": (-1, 0, 0, 0),
    ">": (-1, -1, 0, 0),
    "M": (-1, 1, 0, 0),
    "t": (0, 0, 1, 0),
    "b": (0, 0, -1, 0),
}

SPEEDS: dict[str, tuple[float, float]] = {  # key: factors of the linear and of the angular speed
    "q": (1.1, 1.1),
    "z": (0.9, 0.9),
    "w": (1.1, 1.0),
    "x": (0.9, 1.0),
    "e": (1.0, 1.1),
    "c": (1.0, 0.9),
}

SPEED_RANGE = (0.01, 100.0)  # m/s or rad/s; limits of the speed keys, whose repeats could otherwise run away

HOLD = "F4"  # the AI drone lands while this key is held


class Action(Enum):
    """An action that a key triggers once per press."""

    CAMERA = "next camera"
    IMAGE = "save an image"
    DEBUG = "show or hide the debug view"
    SHALLOWER = "one octree level less"
    DEEPER = "one octree level more"
    PAUSE = "pause or continue"
    RESET = "reset"


ACTIONS = {
    "Tab": Action.CAMERA,
    "F2": Action.IMAGE,
    "p": Action.IMAGE,
    "F3": Action.DEBUG,
    "v": Action.DEBUG,
    "[": Action.SHALLOWER,
    "]": Action.DEEPER,
    "Space": Action.PAUSE,
    "r": Action.RESET,
}


class HeldKey:
    """Estimates which key is held: a terminal repeats a held key but does not report its release.

    A press counts as held for `delay` s, which bridges the time until the first repeat. Presses of the same key less
    than `timeout` s apart are repeats; the key counts as released `timeout` s after the last of them.
    """

    def __init__(self, delay: float, timeout: float) -> None:
        self._delay = delay
        self._timeout = timeout
        self._key: str | None = None
        self._last = -inf
        self._until = -inf

    def press(self, key: str, now: float) -> None:
        """Records a press or a repeat of a key at `now`, in s."""
        repeats = key == self._key and now - self._last < self._timeout
        self._until = now + (self._timeout if repeats else self._delay)
        self._key, self._last = key, now

    def release(self) -> None:
        """Counts the key as released."""
        self._key = None

    def at(self, now: float) -> str | None:
        """The key that counts as held at `now`, in s; None if there is none."""
        if now >= self._until:
            self._key = None
        return self._key


class Controls:
    """Turns key presses into velocities, into hold requests for the AI drone, and into actions.

    speed, turn: initial linear and angular speed, m/s and rad/s. delay, timeout: of HeldKey, in s. cooldown: see
    `press`. latch: a moving key counts as held until another key is pressed, as in teleop_twist_keyboard.
    """

    def __init__(
        self,
        speed: float = 2.0,
        turn: float = 1.0,
        delay: float = 0.6,
        timeout: float = 0.15,
        cooldown: float = 0.25,
        latch: bool = False,
    ) -> None:
        self.speed = speed
        self.turn = turn
        self._cooldown = cooldown
        self._move = HeldKey(inf, inf) if latch else HeldKey(delay, timeout)
        self._hold = HeldKey(delay, timeout)
        self._was_moving = self._was_holding = False
        self._pressed: dict[str, float] = {}

    def press(self, key: str, now: float) -> Action | None:
        """Records a press of a key at `now`, in s, and returns the action that it triggers, if any.

        Presses less than `cooldown` s after the last one trigger nothing: they are repeats of a held key.
        """
        if key in MOVES:
            self._move.press(key, now)
        elif key in SPEEDS:
            linear, angular = SPEEDS[key]
            self.speed = _clamp(self.speed * linear, *SPEED_RANGE)
            self.turn = _clamp(self.turn * angular, *SPEED_RANGE)
        elif key == HOLD:
            self._hold.press(key, now)
        elif key in ACTIONS:
            rested = now - self._pressed.get(key, -inf) >= self._cooldown
            self._pressed[key] = now
            return ACTIONS[key] if rested else None
        else:
            self._move.release()
            self._was_moving = True  # the stop is sent even if another node moves the drone
        return None

    def velocity(self, now: float) -> Velocity | None:
        """Velocity to command at `now`; zero once after the key is released, then None, so that others may command."""
        key = self._move.at(now)
        moved, self._was_moving = self._was_moving, key is not None
        if key is None:
            return (0.0, 0.0, 0.0, 0.0) if moved else None
        x, y, z, yaw = MOVES[key]
        return x * self.speed, y * self.speed, z * self.speed, yaw * self.turn

    def hold(self, now: float) -> bool | None:
        """Whether to hold the AI drone at `now`: True while HOLD is held, False once after it, then None."""
        held, self._was_holding = self._was_holding, self._hold.at(now) is not None
        return self._was_holding or (False if held else None)

    def release(self) -> None:
        """Counts all keys as released."""
        self._move.release()
        self._hold.release()


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)

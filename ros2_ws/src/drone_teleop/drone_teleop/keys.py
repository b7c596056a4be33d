"""What keys mean: teleop_twist_keyboard's table, a few keys more, and how long a key counts as held.

Knows neither ROS nor a terminal; times are seconds of any clock that only goes forward.
"""

from enum import Enum
from math import inf

Velocity = tuple[float, float, float, float]  # x forward, y left, z up in m/s; yaw rate in rad/s

HELP = """\
Keys become velocities of the drone. It works best with a US keyboard layout.
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

F4 (hold) : the AI drone comes down and stays down
Tab       : next camera
F2 or p   : save a picture
F3 or v   : show or hide what collisions see
[ or ]    : show its octrees less or more deeply
Space     : pause, continue
r         : start the simulation over

CTRL-C to quit
"""

MOVES: dict[str, tuple[int, int, int, int]] = {  # key: directions along x, y, z and about z
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

SPEED_RANGE = (0.01, 100.0)  # m/s or rad/s; what keys can reach, so that repeats cannot run away

GROUND = "F4"


class Action(Enum):
    """What a key asks for once, when it is pressed."""

    CAMERA = "next camera"
    PICTURE = "save a picture"
    DEBUG = "show or hide what collisions see"
    SHALLOWER = "octrees a level less deep"
    DEEPER = "octrees a level deeper"
    PAUSE = "pause or continue"
    RESET = "start over"


ACTIONS = {
    "Tab": Action.CAMERA,
    "F2": Action.PICTURE,
    "p": Action.PICTURE,
    "F3": Action.DEBUG,
    "v": Action.DEBUG,
    "[": Action.SHALLOWER,
    "]": Action.DEEPER,
    "Space": Action.PAUSE,
    "r": Action.RESET,
}


class Held:
    """Which key is down, judged from its events: a terminal repeats a held key and says nothing when it is let go.

    A press counts for `delay` s, which bridges the wait for the first repeat. Once events follow each other
    within `timeout` s they are repeats, and the key counts as let go `timeout` s after the last of them.
    """

    def __init__(self, delay: float, timeout: float) -> None:
        self._delay = delay
        self._timeout = timeout
        self._key: str | None = None
        self._last = -inf
        self._until = -inf

    def press(self, key: str, now: float) -> None:
        """Takes an event of a key, its first or a repeat."""
        repeats = key == self._key and now - self._last < self._timeout
        self._until = now + (self._timeout if repeats else self._delay)
        self._key, self._last = key, now

    def release(self) -> None:
        """Forgets the key."""
        self._key = None

    def at(self, now: float) -> str | None:
        """The key that counts as held."""
        if now >= self._until:
            self._key = None
        return self._key


class Hand:
    """What a person's hand on the keyboard asks for.

    With `latch` a moving key counts until another key, as in teleop_twist_keyboard.
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
        self._move = Held(inf, inf) if latch else Held(delay, timeout)
        self._ground = Held(delay, timeout)
        self._moving = self._grounding = False
        self._pressed: dict[str, float] = {}

    def press(self, key: str, now: float) -> Action | None:
        """Takes an event of a key; returns what it asks for once, if it does.

        Such a key needs a rest of `cooldown` s between two events, or its repeats would ask again and again.
        """
        if key in MOVES:
            self._move.press(key, now)
        elif key in SPEEDS:
            linear, angular = SPEEDS[key]
            self.speed = _within(self.speed * linear, *SPEED_RANGE)
            self.turn = _within(self.turn * angular, *SPEED_RANGE)
        elif key == GROUND:
            self._ground.press(key, now)
        elif key in ACTIONS:
            rested = now - self._pressed.get(key, -inf) >= self._cooldown
            self._pressed[key] = now
            return ACTIONS[key] if rested else None
        else:
            self._move.release()
            self._moving = True  # a stop is said even to a drone that somebody else moves
        return None

    def velocity(self, now: float) -> Velocity | None:
        """What to command now: zero once after the key was let go, then None, so that others may command."""
        key = self._move.at(now)
        moved, self._moving = self._moving, key is not None
        if key is None:
            return (0.0, 0.0, 0.0, 0.0) if moved else None
        x, y, z, yaw = MOVES[key]
        return x * self.speed, y * self.speed, z * self.speed, yaw * self.turn

    def grounds(self, now: float) -> bool | None:
        """Whether the AI drone is to come down: True while F4 is held, False once, then None."""
        grounded, self._grounding = self._grounding, self._ground.at(now) is not None
        return self._grounding or (False if grounded else None)

    def release(self) -> None:
        """Lets go of everything that is held."""
        self._move.release()
        self._ground.release()


def _within(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)

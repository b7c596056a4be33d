"""Steps of many drones that touch nothing: a table with one column a drone, moved in blocks of LANES columns."""

import math

import numpy as np

from drone_engine.fleet.integrators import euler, midpoint
from drone_engine.fleet.layout import COMMAND, COMMAND_AGE, LANES, STATE_ROWS
from drone_engine.fleet.stages import rotate_rotors, track_commands
from drone_engine.kernel import kernel


@kernel
def advance(table, block, constants, lag, drag, rotors, seen, second_order, substeps, steps):
    """Moves all drones, the columns of the table (STATE_ROWS, n), by this many steps, block after block.

    block: scratch (BLOCK_ROWS * LANES,). constants: (CONSTANTS,) shared by all drones, see layout.py. lag: as from
    `write_lag_decay`; drag: 0.5 density coefficient of the air drag; rotors, seen, second_order: True if the rotors
    have drag, if their angles are part of the scene, and for the midpoint rule instead of Euler's. Arguments that are
    None leave their part out of the compiled code.
    """
    for first in range(0, table.shape[1], LANES):
        n = min(LANES, table.shape[1] - first)
        for r in range(STATE_ROWS):
            for k in range(n):
                block[r * LANES + k] = table[r, first + k]
        for _ in range(steps):
            track_commands(block, n, constants)
            for sub in range(substeps):
                if second_order is None:
                    euler(block, n, constants, lag, drag, rotors)
                else:
                    midpoint(block, n, constants, lag, drag, rotors, sub)
            if seen is not None:
                rotate_rotors(block, n, constants)
        for r in range(STATE_ROWS):
            for k in range(n):
                table[r, first + k] = block[r * LANES + k]


@kernel
def set_commands(table, command, limit):
    """Gives each of n drones its command: rows of (n, 4), or one for all, (1, 4); numbers are limited to +-limit.

    Returns False, and changes nothing, if a number is not finite.
    """
    for k in range(command.shape[0]):
        for c in range(command.shape[1]):
            if not np.isfinite(command[k, c]):
                return False
    for k in range(table.shape[1]):
        for c in range(4):
            table[COMMAND + c, k] = min(max(command[k % command.shape[0], c], -limit), limit)
        table[COMMAND_AGE, k] = -1.0  # the next step makes it 0
    return True


@kernel
def write_lag_decay(h, substeps, up, down, lag):
    """Shares of a difference in rotor speed that remain, as the stages of a World compute them.

    lag: (substeps + 1, 2), written: row 0 after a sub-step of h s, row 1 + i in the middle of sub-step i; columns:
    speeding up with the time constant `up`, slowing down with `down`, in s.
    """
    lag[0, 0], lag[0, 1] = math.exp(-h / up), math.exp(-h / down)
    for sub in range(substeps):
        t = (sub + 0.5) * h - sub * h
        lag[1 + sub, 0], lag[1 + sub, 1] = math.exp(-t / up), math.exp(-t / down)

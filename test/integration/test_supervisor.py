"""The supervisor of start.py with programs that end, fail, hang and print; the programs are one-liners."""

import os
import pty
import re
import select
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from .live import DEADLINE, NodeProcess

SUPERVISOR = """
import sys, pathlib
from supervisor import Program, Supervisor
log_dir, alone_for, *programs = sys.argv[1:]
def program(text):
    name, kind, code = text.split("|")
    return Program(name, [sys.executable, "-uc", code], terminal=kind == "terminal", leads=kind == "leads",
                   patience=60.0 if kind == "patient" else 0.0)
supervisor = Supervisor([program(text) for text in programs], pathlib.Path(log_dir))
supervisor.run(float(alone_for))
print("failed:", sorted(supervisor.failed))
"""
WAITS = """
import signal, time
print('[INFO] [1.5] [x]: up')
try: time.sleep(100)
except KeyboardInterrupt: print('[INFO] [2.5] [x]: closing')
"""
COUNTS = """
import signal, time
interrupts = []
signal.signal(2, lambda *_: interrupts.append(1))
print('[INFO] [1.5] [x]: up')
while not interrupts: time.sleep(0.02)
time.sleep(0.3)
print('[INFO] [2.5] [x]: interrupted', len(interrupts), 'times')
"""
FINISHES = """
import signal, time
signal.signal(15, lambda *_: (time.sleep(2.5), print('[INFO] [2.5] [x]: finished'), exit(0)))
print('[INFO] [1.5] [x]: up')
time.sleep(100)
"""
HARD_OF_HEARING = """
import signal, time
asked = []
signal.signal(2, lambda *_: asked.append(1))
print('[INFO] [1.5] [x]: up')
while len(asked) < 2: time.sleep(0.02)
print('[INFO] [2.5] [x]: closing')
"""
DEAF = "import signal, time; signal.signal(2, signal.SIG_IGN); print('[INFO] [1.0] [x]: up'); time.sleep(100)"

WORKSPACE = Path(__file__).parents[2] / "ros2_ws"
Supervise = Callable[..., NodeProcess]


@pytest.fixture
def supervise(tmp_path: Path, request: pytest.FixtureRequest) -> Supervise:
    """Starts a supervisor of the programs 'name|kind|code'."""

    def start(*programs: str, alone_for: float = 0.0) -> NodeProcess:
        command = [sys.executable, "-uc", SUPERVISOR, str(tmp_path), str(alone_for), *programs]
        process = NodeProcess("supervisor", command, os.environ | {"PYTHONPATH": str(WORKSPACE)})
        request.addfinalizer(process.kill)
        return process

    return start


def wait_for_output(process: NodeProcess, text: str) -> None:
    deadline = time.monotonic() + DEADLINE
    while text not in process.output():
        assert time.monotonic() < deadline, f"'{text}' has not been said:\n{process.output()}"
        time.sleep(0.02)


def test_leader_that_is_done_ends_the_others(supervise: Supervise, tmp_path: Path) -> None:
    process = supervise("sim|leads|import time; time.sleep(2)", f"other||{WAITS}")
    assert process.wait() == 0
    assert "failed: []" in process.output()
    assert "other | closing" in process.output()
    assert "[INFO] [1.5] [x]: up\n" in (tmp_path / "other.log").read_text()


def test_what_has_patience_finishes_its_work_when_the_leader_is_done(supervise: Supervise) -> None:
    process = supervise("sim|leads|import time; time.sleep(3)", f"film|patient|{FINISHES}", f"other||{WAITS}")
    assert process.wait() == 0
    assert "film  | finished" in process.output()  # although that takes longer than the rest may
    assert "failed: []" in process.output()


def test_what_missed_the_first_signal_is_asked_again(supervise: Supervise) -> None:
    process = supervise(f"sim|leads|{WAITS}", f"other||{HARD_OF_HEARING}")
    wait_for_output(process, "other | up")
    assert process.interrupt() == 0
    assert "other | closing" in process.output()
    assert "failed: []" in process.output()


def test_ctrl_c_has_no_patience(supervise: Supervise) -> None:
    process = supervise(f"sim|leads|{WAITS}", f"film|patient|{WAITS}")
    wait_for_output(process, "film | up")
    assert process.interrupt() == 0
    assert process.output().count("closing") == 2


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_all_once(supervise: Supervise, number: signal.Signals) -> None:
    process = supervise(f"sim|leads|{WAITS}", f"other||{WAITS}")
    wait_for_output(process, "other | up")
    wait_for_output(process, "sim   | up")
    process.send(number)
    assert process.wait() == 0
    assert process.output().count("closing") == 2
    assert "failed: []" in process.output()


def test_death_is_named_with_its_last_lines_and_the_others_go_on(supervise: Supervise) -> None:
    killed = "import os; os.kill(os.getpid(), 9)"
    process = supervise(f"sim|leads|{WAITS}", "other||print('first'); 1 / 0", f"third||{killed}")
    wait_for_output(process, "other failed with exit status 1; last lines:")
    wait_for_output(process, "third was killed by SIGKILL; no output")
    wait_for_output(process, "sim   | up")
    last = r"other \|   first\nother \|   Traceback.*\nother \|   ZeroDivisionError"
    assert re.search(last, process.output(), re.DOTALL)
    process.send(signal.SIGINT)
    assert process.wait() == 0
    assert "sim   | closing" in process.output()
    assert "failed: ['other', 'third']" in process.output()


def test_without_its_leader_a_run_ends_when_the_time_is_over(supervise: Supervise) -> None:
    process = supervise("sim|leads|raise SystemExit(3)", f"other||{WAITS}", alone_for=1.0)
    wait_for_output(process, "sim failed with exit status 3")
    assert process.wait() == 0
    assert "other | closing" in process.output()
    assert "failed: ['sim']" in process.output()


def test_what_does_not_end_is_killed(supervise: Supervise) -> None:
    process = supervise(f"sim|leads|{WAITS}", f"deaf||{DEAF}")
    wait_for_output(process, "deaf | up")
    wait_for_output(process, "sim  | up")
    process.send(signal.SIGINT)
    assert process.wait() == 0
    assert "deaf did not end in time and was killed" in process.output()
    assert "failed: ['deaf']" in process.output()


def test_people_see_news_and_warnings_but_not_the_rest(supervise: Supervise, tmp_path: Path) -> None:
    talk = (
        "print('noise'); print('[DEBUG] [1.0] [n]: detail'); print('[INFO] [1.0] [n]: news');"
        "print('[WARN] [1.0] [n]: careful\\nsecond line'); print('[INFO] [1.0] [n]: more\\nafter', end='')"
    )
    process = supervise(f"sim|leads|{talk}")
    assert process.wait() == 0
    assert process.output() == "sim | news\nsim | WARN: careful\nsim | second line\nsim | more\nfailed: []\n"
    assert (tmp_path / "sim.log").read_text().split("\n")[0] == "noise"


def test_programs_end_although_the_supervisor_is_killed(supervise: Supervise, tmp_path: Path) -> None:
    process = supervise(f"sim|leads|{WAITS}")
    wait_for_output(process, "sim | up")
    process.send(signal.SIGKILL)
    process.wait()
    deadline = time.monotonic() + DEADLINE
    # The pipe has no reader any more: the program's last words do not arrive, but it hears of the end.
    while any(_runs(entry, WAITS) for entry in Path("/proc").iterdir()):
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_ctrl_c_in_a_terminal_reaches_every_program_once(tmp_path: Path) -> None:
    programs = [f"sim|leads|{COUNTS}", f"hands|terminal|{WAITS}"]
    pid, terminal = pty.fork()
    if pid == 0:
        os.environ["PYTHONPATH"] = str(WORKSPACE)
        os.execv(sys.executable, [sys.executable, "-uc", SUPERVISOR, str(tmp_path), "0", *programs])
    output = b""
    while b"[x]: up" not in output or b"sim   | up" not in output:  # the terminal's own program is not reworded
        output += _read_terminal(terminal)
    os.write(terminal, b"\x03")
    while data := _read_terminal(terminal):
        output += data
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
    assert b"sim   | interrupted 1 times" in output
    assert b"failed: []" in output


def _read_terminal(terminal: int) -> bytes:
    """What has been written to the terminal; nothing when nobody has it open any more."""
    assert select.select([terminal], [], [], DEADLINE)[0], "the terminal is silent"
    try:
        return os.read(terminal, 1 << 12)
    except OSError:
        return b""


def _runs(entry: Path, code: str) -> bool:
    try:
        return (entry / "cmdline").read_bytes().endswith(f"-uc\0{code}\0".encode())
    except OSError:
        return False

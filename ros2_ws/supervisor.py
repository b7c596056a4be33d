"""Runs programs side by side: starts them, shows their output, reports the failure of any, and ends them all.

One thread waits on one selector for the programs' output and, through the signal wake-up pipe, for SIGCHLD,
SIGINT and SIGTERM; so the end of a program is noticed at once, without polling.
"""

import ctypes
import os
import re
import selectors
import signal
import socket
import subprocess
import sys
import time
from collections import deque
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import IO, Self

SPACING = 0.5  # s between two starts: programs that join a ROS graph at the same moment may miss each other
GRACE = 1.8  # s between the first signal to end and SIGKILL
LAST_LINES = 15  # lines of output repeated when a program fails
CLEAN_STATUS = (0, -signal.SIGINT, -signal.SIGTERM, 128 + signal.SIGINT)  # of a program that ended on request

_LOG_LINE = re.compile(r"\[(DEBUG|INFO|WARN|ERROR|FATAL)\] \[[\d.]+\] \[[^\]]*\]: ?(.*)")  # rcutils' format
_PR_SET_PDEATHSIG = 1  # linux/prctl.h
_libc = ctypes.CDLL(None)


@dataclass(frozen=True)
class Program:
    """A program to start, and its role among the others."""

    name: str
    command: list[str]
    environment: dict[str, str] = field(default_factory=dict)  # added to this process's environment
    terminal: bool = False  # interactive: it keeps the terminal; when the user quits it, all end
    leads: bool = False  # when it ends cleanly, all end
    niceness: int = 0  # above 0: lower priority
    patience: float = 0.0  # s that it may take to finish its work after SIGTERM, once the leading program has ended


@dataclass
class _Running:
    program: Program
    process: subprocess.Popen[bytes]
    log: IO[bytes]
    rest: bytes = b""  # an incomplete line
    urgent: bool = False  # the last message was a warning or an error; its further lines are shown as well
    last: deque[str] = field(default_factory=lambda: deque(maxlen=LAST_LINES))

    def ended_cleanly(self, status: int) -> bool:
        """Whether a program ended on request; Python exits with 1 if SIGINT arrives while it starts."""
        return status in CLEAN_STATUS or (bool(self.last) and self.last[-1].startswith("KeyboardInterrupt"))


class Supervisor:
    """Runs programs until the leading one ends or the user interrupts; `failed` names the programs that failed."""

    def __init__(self, programs: list[Program], log_dir: Path, verbose: bool = False) -> None:
        self.failed: list[str] = []
        self._programs = programs
        self._log_dir = log_dir
        self._verbose = verbose
        self._running: dict[str, _Running] = {}
        self._ending = False
        self._colors = sys.stdout.isatty() and "NO_COLOR" not in os.environ
        self._width = max(len(program.name) for program in programs)

    def run(self, alone_for: float = 0.0) -> None:
        """Returns when all programs have ended.

        If the leading program fails, the others continue until `alone_for` s after the start; 0 means forever.
        """
        start = time.monotonic()
        deadline: float | None = None  # s; the time to end all, or, once they are ending, to send a stronger signal
        repeated = False  # whether all got a second signal: a Python program may lose SIGINT while it imports
        with selectors.DefaultSelector() as selector, _SignalPipe() as signals:
            selector.register(signals, selectors.EVENT_READ)
            waiting = deque(enumerate(self._programs))
            while self._running or waiting:
                if waiting and time.monotonic() >= start + waiting[0][0] * SPACING:
                    self._start(waiting.popleft()[1], selector)
                    continue
                times = [start + waiting[0][0] * SPACING] if waiting else []
                times += [deadline] if deadline is not None else []
                timeout = max(0.0, min(times) - time.monotonic()) if times else None
                for key in [key for key, _ in selector.select(timeout)]:
                    if key.data and not self._read(key.data):
                        selector.unregister(key.fileobj)
                interrupted = signals.end_requested()
                done, lost = self._reap(selector)
                if lost and alone_for and not self._ending:
                    deadline = start + alone_for
                due = deadline is not None and time.monotonic() >= deadline
                if self._ending and due and repeated:
                    self._kill()
                elif self._ending and due:
                    self._end(patiently=False)
                    repeated, deadline = True, time.monotonic() + GRACE / 2
                elif interrupted or (not self._ending and (due or done)):
                    waiting.clear()
                    deadline = time.monotonic() + self._end(patiently=done and not interrupted) - GRACE / 2

    def print(self, name: str, text: str, style: str = "") -> None:
        """Prints one line after the program's name."""
        line = f"{name:{self._width}} | {self._paint(text, style)}"
        # An interactive program may have left the cursor in a line: overwrite that line.
        print(f"\r\x1b[K{line}" if sys.stdout.isatty() else line, flush=True)

    def _start(self, program: Program, selector: selectors.BaseSelector) -> None:
        own = program.terminal
        process = subprocess.Popen(
            program.command,
            env=os.environ | program.environment,
            stdin=None if own else subprocess.DEVNULL,
            stdout=None if own else subprocess.PIPE,
            stderr=None if own else subprocess.STDOUT,
            start_new_session=not own,  # else Ctrl-C would reach it twice: from the terminal and from this process
            preexec_fn=partial(_prepare, program.niceness),  # safe: this process has one thread
        )
        running = _Running(program, process, (self._log_dir / f"{program.name}.log").open("wb"))
        self._running[program.name] = running
        if process.stdout:
            os.set_blocking(process.stdout.fileno(), False)
            selector.register(process.stdout, selectors.EVENT_READ, running)

    def _read(self, running: _Running) -> bool:
        """Reads all available output; returns False at its end."""
        assert running.process.stdout
        while True:
            try:
                data = os.read(running.process.stdout.fileno(), 1 << 16)
            except BlockingIOError:
                return True
            running.log.write(data)
            *lines, running.rest = (running.rest + data).split(b"\n")
            if not data and running.rest:
                lines, running.rest = [running.rest], b""
            for line in lines:
                self._show(running, line.decode(errors="replace").rstrip())
            running.log.flush()
            if not data:
                return False

    def _show(self, running: _Running, line: str) -> None:
        running.last.append(line)
        message = _LOG_LINE.fullmatch(line)
        level, text = message.groups() if message else ("", line)
        if message:
            running.urgent = level in ("WARN", "ERROR", "FATAL")
        if running.urgent:
            style = "33" if level == "WARN" else "31" if level else "2"
            self.print(running.program.name, f"{level}: {text}" if level else text, style)
        elif level == "INFO" or self._verbose:
            self.print(running.program.name, text)

    def _reap(self, selector: selectors.BaseSelector) -> tuple[bool, bool]:
        """Reaps exited processes. Returns whether the run is done, and whether its leading program has failed."""
        done = lost = False
        for name, running in list(self._running.items()):
            status = running.process.poll()
            if status is None:
                continue
            del self._running[name]
            if pipe := running.process.stdout:
                self._read(running)
                if pipe in selector.get_map():
                    selector.unregister(pipe)
                pipe.close()
            running.log.close()
            if status == 0 and (running.program.leads or running.program.terminal):
                done = True
            elif not (self._ending and running.ended_cleanly(status)):
                lost |= running.program.leads
                self._report(running, status)
        return done, lost

    def _report(self, running: _Running, status: int) -> None:
        name = running.program.name
        self.failed.append(name)
        how = f"was killed by {signal.Signals(-status).name}" if status < 0 else f"failed with exit status {status}"
        last = "last lines:" if running.last else "no output"
        self.print(name, f"{name} {how}; {last}", "1;31")
        for line in running.last:
            self.print(name, f"  {line}", "2")

    def _end(self, patiently: bool) -> float:
        """Tells all programs to end; returns the time they have, in s. Those that the terminal signals get SIGTERM."""
        self._ending = True
        grace = GRACE
        for running in self._running.values():
            program = running.program
            finishing = patiently and program.patience > 0.0
            grace = max(grace, program.patience) if finishing else grace
            running.process.send_signal(signal.SIGTERM if program.terminal or finishing else signal.SIGINT)
        return grace

    def _kill(self) -> None:
        for name, running in self._running.items():
            self.print(name, f"{name} did not end in time and was killed", "1;31")
            if running.program.terminal:
                running.process.kill()
            else:
                os.killpg(running.process.pid, signal.SIGKILL)
            running.process.wait()

    def _paint(self, text: str, style: str) -> str:
        return f"\x1b[{style}m{text}\x1b[0m" if style and self._colors else text


class _SignalPipe:
    """A file that becomes readable when a signal arrives; signals have no other effect while it is open."""

    CAUGHT = (signal.SIGCHLD, signal.SIGINT, signal.SIGTERM)

    def __enter__(self) -> Self:
        self._receiver, self._sender = socket.socketpair()
        self._receiver.setblocking(False)
        self._sender.setblocking(False)
        self._old_pipe = signal.set_wakeup_fd(self._sender.fileno(), warn_on_full_buffer=False)
        self._old = {number: signal.signal(number, lambda *_: None) for number in self.CAUGHT}
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._old.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(self._old_pipe)
        self._receiver.close()
        self._sender.close()

    def fileno(self) -> int:
        return self._receiver.fileno()

    def end_requested(self) -> bool:
        """Empties the pipe; returns whether SIGINT or SIGTERM was in it."""
        try:
            return bool({signal.SIGINT, signal.SIGTERM} & set(self._receiver.recv(1 << 12)))
        except BlockingIOError:
            return False


def _prepare(niceness: int) -> None:
    """In a new process: sets its priority, and has the kernel send SIGINT when the parent ends in any way."""
    os.nice(niceness)
    _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGINT)

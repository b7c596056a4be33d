"""Runs programs side by side: starts them, shows what they say, notices who dies, ends them all.

One thread waits on one selector for the programs' output and, through the signal wake-up pipe, for SIGCHLD,
SIGINT and SIGTERM; so a death is known at once, and nothing polls.
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

SPACING = 0.5  # s between two starts: programs that join a ROS graph at the same moment may miss each other's answers
GRACE = 1.8  # s between being asked to end and SIGKILL
LAST_WORDS = 15  # lines of a dead program that are repeated
CLEAN_STATUS = (0, -signal.SIGINT, -signal.SIGTERM, 128 + signal.SIGINT)  # of a program that was asked to end

_LOG_LINE = re.compile(r"\[(DEBUG|INFO|WARN|ERROR|FATAL)\] \[[\d.]+\] \[[^\]]*\]: ?(.*)")  # rcutils' format
_PR_SET_PDEATHSIG = 1  # linux/prctl.h
_libc = ctypes.CDLL(None)


@dataclass(frozen=True)
class Program:
    """What to start, and how it matters to the others."""

    name: str
    command: list[str]
    environment: dict[str, str] = field(default_factory=dict)  # on top of this process's own
    terminal: bool = False  # it talks with the person: the terminal stays its own; when they quit it, all end
    leads: bool = False  # when it is done, all end
    niceness: int = 0  # above 0, it stands back where processors are few
    patience: float = 0.0  # s that it may take to finish its work once the leading one is done; SIGTERM tells it so


@dataclass
class _Running:
    program: Program
    process: subprocess.Popen[bytes]
    log: IO[bytes]
    rest: bytes = b""  # the beginning of a line whose end has not arrived
    urgent: bool = False  # the last message was a warning or worse, so are the lines that belong to it
    last: deque[str] = field(default_factory=lambda: deque(maxlen=LAST_WORDS))

    def ended_as_asked(self, status: int) -> bool:
        """Whether this is how a program ends on SIGINT; Python's own start turns that into status 1."""
        return status in CLEAN_STATUS or (bool(self.last) and self.last[-1].startswith("KeyboardInterrupt"))


class Supervisor:
    """Runs programs until the leading one is done or the person has had enough; `died` names the failures."""

    def __init__(self, programs: list[Program], log_dir: Path, verbose: bool = False) -> None:
        self.died: list[str] = []
        self._programs = programs
        self._log_dir = log_dir
        self._verbose = verbose
        self._running: dict[str, _Running] = {}
        self._ending = False
        self._colours = sys.stdout.isatty() and "NO_COLOR" not in os.environ
        self._width = max(len(program.name) for program in programs)

    def run(self, alone_for: float = 0.0) -> None:
        """Returns when nothing runs any more.

        If the leading program dies, the rest go on until `alone_for` s after the start; 0 means endlessly.
        """
        start = time.monotonic()
        deadline: float | None = None  # what is due then: the end, or while ending more pressure
        urged = False  # asked twice: a Python program that is just importing may swallow the first SIGINT
        with selectors.DefaultSelector() as selector, _SignalPipe() as signals:
            selector.register(signals, selectors.EVENT_READ)
            waiting = deque(enumerate(self._programs))
            while self._running or waiting:
                if waiting and time.monotonic() >= start + waiting[0][0] * SPACING:
                    self._start(waiting.popleft()[1], selector)
                    continue
                moments = [start + waiting[0][0] * SPACING] if waiting else []
                moments += [deadline] if deadline is not None else []
                timeout = max(0.0, min(moments) - time.monotonic()) if moments else None
                for key in [key for key, _ in selector.select(timeout)]:
                    if key.data and not self._read(key.data):
                        selector.unregister(key.fileobj)
                asked = signals.asked_to_end()
                done, lost = self._bury(selector)
                if lost and alone_for and not self._ending:
                    deadline = start + alone_for
                due = deadline is not None and time.monotonic() >= deadline
                if self._ending and due and urged:
                    self._kill()
                elif self._ending and due:
                    self._end(patiently=False)
                    urged, deadline = True, time.monotonic() + GRACE / 2
                elif asked or (not self._ending and (due or done)):
                    waiting.clear()
                    deadline = time.monotonic() + self._end(patiently=done and not asked) - GRACE / 2

    def say(self, name: str, text: str, style: str = "") -> None:
        """One line on the terminal, the program's name in front."""
        line = f"{name:{self._width}} | {self._paint(text, style)}"
        # A program that owns the terminal may be in the middle of a line: write over it.
        print(f"\r\x1b[K{line}" if sys.stdout.isatty() else line, flush=True)

    def _start(self, program: Program, selector: selectors.BaseSelector) -> None:
        own = program.terminal
        process = subprocess.Popen(
            program.command,
            env=os.environ | program.environment,
            stdin=None if own else subprocess.DEVNULL,
            stdout=None if own else subprocess.PIPE,
            stderr=None if own else subprocess.STDOUT,
            start_new_session=not own,  # else Ctrl-C would reach it twice: from the terminal and from here
            preexec_fn=partial(_prepare, program.niceness),  # there is one thread only
        )
        running = _Running(program, process, (self._log_dir / f"{program.name}.log").open("wb"))
        self._running[program.name] = running
        if process.stdout:
            os.set_blocking(process.stdout.fileno(), False)
            selector.register(process.stdout, selectors.EVENT_READ, running)

    def _read(self, running: _Running) -> bool:
        """Takes all output that there is; false at its end."""
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
            self.say(running.program.name, f"{level}: {text}" if level else text, style)
        elif level == "INFO" or self._verbose:
            self.say(running.program.name, text)

    def _bury(self, selector: selectors.BaseSelector) -> tuple[bool, bool]:
        """Takes leave of programs that have ended. Tells whether the run is done, and whether its leader died."""
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
            elif not (self._ending and running.ended_as_asked(status)):
                lost |= running.program.leads
                self._report(running, status)
        return done, lost

    def _report(self, running: _Running, status: int) -> None:
        name = running.program.name
        self.died.append(name)
        how = f"was ended by {signal.Signals(-status).name}" if status < 0 else f"died with exit status {status}"
        last = "its last lines:" if running.last else "it had said nothing"
        self.say(name, f"{name} {how}; {last}", "1;31")
        for line in running.last:
            self.say(name, f"  {line}", "2")

    def _end(self, patiently: bool) -> float:
        """Asks all to end; returns in how many s they have to. SIGTERM where the terminal may have sent SIGINT."""
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
            self.say(name, f"{name} did not end in time and is killed", "1;31")
            if running.program.terminal:
                running.process.kill()
            else:
                os.killpg(running.process.pid, signal.SIGKILL)
            running.process.wait()

    def _paint(self, text: str, style: str) -> str:
        return f"\x1b[{style}m{text}\x1b[0m" if style and self._colours else text


class _SignalPipe:
    """A file that becomes readable when a signal arrives; signals do nothing else while it is open."""

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

    def asked_to_end(self) -> bool:
        """Empties the pipe; true if SIGINT or SIGTERM was in it."""
        try:
            return bool({signal.SIGINT, signal.SIGTERM} & set(self._receiver.recv(1 << 12)))
        except BlockingIOError:
            return False


def _prepare(niceness: int) -> None:
    """In a new process: have the kernel send SIGINT when the parent is gone, however it went."""
    os.nice(niceness)
    _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGINT)

"""Writes a bag: a folder with metadata.yaml and one file of messages."""

import fcntl
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Self

from drone_sim.bag.metadata import Summary
from drone_sim.bag.storage import STORAGES, BagError, Topic

CHUNK_SIZE = 256 * 1024  # bytes of messages, after which they go to disk


class BagWriter:
    """Writes serialized messages into a new bag; storage: 'mcap' or 'sqlite3'.

    Call `flush` about once a second: after it, and after every 256 KiB, all messages so far survive a kill -9.
    Every method raises BagError if writing to disk fails; the bag is then closed as it is.
    """

    def __init__(self, path: Path, storage: str = "mcap") -> None:
        if storage not in STORAGES:
            raise BagError(f"{path}: storage: expected one of {', '.join(STORAGES)}, got '{storage}'")
        if path.exists():
            raise BagError(f"{path}: expected a new folder, got an existing one; bags are never overwritten")
        self.path = path
        self._open = False
        with self._errors():
            path.mkdir(parents=True)
            self._lock = lock(path)
            self._storage = STORAGES[storage](path)
            self._open = True
            self._summary = Summary(storage, self._storage.path.name)
            self._summary.save(path)
        self._numbers: dict[str, int] = {}
        self._pending = 0  # bytes
        self._new_topics = False
        self.bytes = 0

    @property
    def messages(self) -> int:
        """Number of messages of all topics."""
        return self._summary.messages

    @property
    def topics(self) -> int:
        """Number of topics."""
        return len(self._numbers)

    def add_topic(self, topic: Topic) -> None:
        """Adds a topic; required before its first message."""
        with self._errors():
            self._numbers[topic.name] = self._storage.add_topic(topic)
        self._summary.topics.append(topic)
        self._summary.counts.append(0)
        self._new_topics = True

    def write(self, topic: str, time: int, data: bytes) -> None:
        """Adds a message in CDR of a topic, received at `time` in ns."""
        number = self._numbers[topic]
        with self._errors():
            self._storage.write(number, time, data)
        self._summary.count(number - 1, time)
        self.bytes += len(data)
        self._pending += len(data)
        if self._pending >= CHUNK_SIZE:
            self.flush()

    def flush(self) -> None:
        """Ends the chunk: all messages so far can be read back even if this process is killed."""
        with self._errors():
            self._storage.flush()
            if self._new_topics:
                self._summary.save(self.path)
        self._pending = 0
        self._new_topics = False

    def close(self) -> None:
        """Completes the bag; calling it again has no effect."""
        if self._open:
            with self._errors():
                self._storage.close(self._summary.text())
                self._summary.save(self.path)
            self._open = False
            os.close(self._lock)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @contextmanager
    def _errors(self) -> Iterator[None]:
        """Turns errors of the disk into a BagError and closes the bag as it is."""
        try:
            yield
        except (OSError, sqlite3.Error) as error:
            if self._open:
                self._open = False
                with suppress(OSError, sqlite3.Error):
                    self._storage.abort()
                os.close(self._lock)
            raise BagError(f"{self.path}: {getattr(error, 'strerror', None) or error}") from None


def lock(path: Path) -> int:
    """Locks the folder of a bag until the returned descriptor is closed or the process ends. Raises BagError."""
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise BagError(f"{path}: another process is writing this bag") from None
    return descriptor

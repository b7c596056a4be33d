"""The two file formats of a bag, MCAP and SQLite."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import yaml
from mcap.writer import CompressionType, Writer
from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition, MessageDefinitionFormat, Qos
from rosbags.rosbag2.enums import CompressionMode
from rosbags.rosbag2.metadata import dump_qos_v9
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

METADATA_VERSION = 9  # of rosbag2, that of Jazzy


class BagError(Exception):
    """A bag that cannot be written or read, in one line that begins with its path."""


@dataclass(frozen=True)
class Topic:
    """A recorded topic: its full name, type, definition (ros2msg), RIHS01 hash, and its publishers' QoS."""

    name: str
    type: str
    definition: str
    hash: str
    qos: tuple[Qos, ...] = ()

    def qos_yaml(self) -> str:
        """The offered QoS profiles as YAML, as rosbag2 stores them with a topic."""
        return yaml.safe_dump(dump_qos_v9(list(self.qos)), sort_keys=False).strip()


class Storage(Protocol):
    """A file of messages. Topics are numbered from 1; times are in ns."""

    path: Path

    def add_topic(self, topic: Topic) -> int:
        """Adds a topic and returns its number."""

    def write(self, number: int, time: int, data: bytes) -> None:
        """Adds a message of a topic, which the next flush writes."""

    def flush(self) -> None:
        """Passes all messages so far to the operating system, in a form that can be read back."""

    def close(self, metadata: str) -> None:
        """Flushes, writes the index and closes the file. metadata: the text of metadata.yaml."""

    def abort(self) -> None:
        """Closes the file as it is."""


class McapStorage:
    """An MCAP file with one chunk per flush, not compressed, which is the default of `ros2 bag record`."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / f"{folder.name}.mcap"
        self._file = self.path.open("xb", buffering=0)
        # The caller ends each chunk by `flush`.
        self._writer = Writer(self._file, chunk_size=sys.maxsize, compression=CompressionType.NONE)
        self._writer.start(profile="ros2", library="drone_sim")
        self._writer.flush()
        self._schemas: dict[str, int] = {}

    def add_topic(self, topic: Topic) -> int:
        if topic.type not in self._schemas:
            data = topic.definition.encode()
            self._schemas[topic.type] = self._writer.register_schema(topic.type, "ros2msg", data)
        metadata = {"offered_qos_profiles": topic.qos_yaml(), "topic_type_hash": topic.hash}
        number: int = self._writer.register_channel(topic.name, "cdr", self._schemas[topic.type], metadata)
        return number

    def write(self, number: int, time: int, data: bytes) -> None:
        self._writer.add_message(number, log_time=time, publish_time=time, data=data)

    def flush(self) -> None:
        self._writer.flush()

    def close(self, metadata: str) -> None:
        self._writer.flush()
        self._writer.add_metadata("rosbag2", {"serialized_metadata": metadata})
        self._writer.finish()
        self._writer.flush()
        self._file.close()

    def abort(self) -> None:
        self._file.close()


class SqliteStorage:
    """An SQLite file with one transaction per flush."""

    def __init__(self, folder: Path) -> None:
        self._storage = Sqlite3Writer(folder, CompressionMode.NONE)
        # What the operating system has received survives the death of this process; no need to wait for disks.
        self._storage.conn.execute("PRAGMA synchronous = OFF")
        self.path = self._storage.path
        self._connections: list[Connection] = []

    def add_topic(self, topic: Topic) -> int:
        number = len(self._connections) + 1
        connection = Connection(
            id=number, topic=topic.name, msgtype=topic.type,
            msgdef=MessageDefinition(MessageDefinitionFormat.MSG, topic.definition), digest=topic.hash,
            msgcount=0, ext=ConnectionExtRosbag2("cdr", list(topic.qos)), owner=self,
        )
        if topic.type not in (known.msgtype for known in self._connections):
            self._storage.add_msgtype(connection)
        self._storage.add_connection(connection, topic.qos_yaml())
        self._connections.append(connection)
        return number

    def write(self, number: int, time: int, data: bytes) -> None:
        self._storage.write(self._connections[number - 1], time, data)

    def flush(self) -> None:
        self._storage.conn.commit()

    def close(self, metadata: str) -> None:
        self._storage.close(METADATA_VERSION, metadata)

    def abort(self) -> None:
        self._storage.abort()


STORAGES: dict[str, type[McapStorage | SqliteStorage]] = {"mcap": McapStorage, "sqlite3": SqliteStorage}

"""Completes a bag whose writer was killed."""

import os
import shutil
import sqlite3
import struct
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import yaml
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Channel, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader
from rosbags.interfaces import ConnectionExtRosbag2
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.errors import ReaderError
from rosbags.rosbag2.metadata import parse_qos

from drone_sim.bag.metadata import FILE, Summary
from drone_sim.bag.storage import BagError, Topic
from drone_sim.bag.writer import BagWriter, lock


def recover(path: Path) -> bool:
    """Completes the bag in a folder from its intact records; returns False if the bag is already complete.

    Readers of MCAP need an index at the end of the file: the intact chunks are copied into a new file with an index,
    which then replaces the old one; until then the old file is not changed. SQLite repairs its file itself.
    Raises BagError.
    """
    if not path.is_dir():
        raise BagError(f"{path}: expected a folder, found none")
    files = sorted([*path.glob("*.mcap"), *path.glob("*.db3")])
    if len(files) != 1:
        raise BagError(f"{path}: expected one .mcap or .db3 file, got {len(files)}")
    descriptor = lock(path)
    try:
        return _recover_mcap(path, files[0]) if files[0].suffix == ".mcap" else _recover_sqlite(path, files[0])
    except (OSError, sqlite3.Error, McapError, ReaderError) as error:
        raise BagError(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    finally:
        os.close(descriptor)


def _recover_mcap(path: Path, file: Path) -> bool:
    if _is_complete(path, file):
        return False
    scratch = path / ".recovering"
    shutil.rmtree(scratch, ignore_errors=True)
    with BagWriter(scratch / path.name) as bag:
        schemas: dict[int, Schema] = {}
        names: dict[int, str] = {}
        for record in _intact_records(file):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.id not in names:
                bag.add_topic(_topic(record, schemas[record.schema_id]))
                names[record.id] = record.topic
            elif isinstance(record, Message):
                bag.write(names[record.channel_id], record.log_time, record.data)
    (bag.path / f"{path.name}.mcap").replace(path / f"{path.name}.mcap")
    (bag.path / FILE).replace(path / FILE)
    if file.name != f"{path.name}.mcap":
        file.unlink()
    shutil.rmtree(scratch)
    return True


def _is_complete(path: Path, file: Path) -> bool:
    """Whether the file has its index and the number of messages that metadata.yaml states."""
    try:
        with file.open("rb") as stream:
            summary = make_reader(stream).get_summary()
    except (McapError, struct.error, OSError):
        return False
    return bool(summary and summary.statistics and summary.statistics.message_count == _stated_count(path))


def _stated_count(path: Path) -> int | None:
    """The number of messages in metadata.yaml; None if it cannot be read."""
    try:
        count: int = yaml.safe_load((path / FILE).read_bytes())["rosbag2_bagfile_information"]["message_count"]
    except (OSError, yaml.YAMLError, TypeError, KeyError):
        return None
    return count


def _intact_records(file: Path) -> Iterator[McapRecord]:
    """The intact records of an MCAP file, those inside its chunks included."""
    with file.open("rb") as stream:
        try:
            yield from StreamReader(stream, validate_crcs=True).records
        except (McapError, struct.error, UnicodeDecodeError):  # a truncated record may raise any of these
            return


def _topic(channel: Channel, schema: Schema) -> Topic:
    qos = tuple(parse_qos(channel.metadata.get("offered_qos_profiles", "")))
    return Topic(channel.topic, schema.name, schema.data.decode(), channel.metadata.get("topic_type_hash", ""), qos)


def _recover_sqlite(path: Path, file: Path) -> bool:
    with closing(sqlite3.connect(file)) as database:  # rolls an unfinished transaction back
        (messages,) = database.execute("SELECT count(*) FROM messages").fetchone()
        if messages == _stated_count(path):
            return False
        start, end = database.execute("SELECT min(timestamp), max(timestamp) FROM messages").fetchone()
    summary = Summary("sqlite3", file.name, messages=messages, start=start or 0, end=end or 0)
    with Reader(file) as reader:
        for connection in reader.connections:
            assert isinstance(connection.ext, ConnectionExtRosbag2)
            qos = tuple(connection.ext.offered_qos_profiles)
            summary.topics.append(
                Topic(connection.topic, connection.msgtype, connection.msgdef.data, connection.digest, qos)
            )
            summary.counts.append(connection.msgcount)
    summary.save(path)
    return True

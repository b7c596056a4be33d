"""metadata.yaml, which describes the messages of a bag."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from rosbags.rosbag2.metadata import dump_qos_v9

from drone_sim.bag.storage import METADATA_VERSION, Topic

FILE = "metadata.yaml"


@dataclass
class Summary:
    """Contents of a bag: its file, topics, number of messages of each, and the first and last time in ns."""

    storage: str
    file: str
    topics: list[Topic] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    messages: int = 0
    start: int = 0
    end: int = 0

    def count(self, index: int, time: int) -> None:
        """Counts a message of the topic at an index, received at `time` in ns."""
        if not self.messages:
            self.start = self.end = time
        self.start = min(self.start, time)
        self.end = max(self.end, time)
        self.counts[index] += 1
        self.messages += 1

    def information(self) -> dict[str, Any]:
        """The fields of metadata.yaml, version 9 (Jazzy)."""
        times_and_count = {
            "starting_time": {"nanoseconds_since_epoch": self.start},
            "duration": {"nanoseconds": self.end - self.start},
            "message_count": self.messages,
        }
        return {
            "version": METADATA_VERSION,
            "storage_identifier": self.storage,
            "relative_file_paths": [self.file],
            **times_and_count,
            "topics_with_message_count": [
                {
                    "topic_metadata": {
                        "name": topic.name,
                        "type": topic.type,
                        "serialization_format": "cdr",
                        "offered_qos_profiles": dump_qos_v9(list(topic.qos)),
                        "type_description_hash": topic.hash,
                    },
                    "message_count": count,
                }
                for topic, count in zip(self.topics, self.counts, strict=True)
            ],
            "compression_format": "",
            "compression_mode": "",
            "files": [{"path": self.file, **times_and_count}],
            "custom_data": None,
            "ros_distro": "jazzy",
        }

    def text(self) -> str:
        """The information as YAML, which rosbag2 also stores inside the MCAP file."""
        return _dump(self.information())

    def save(self, folder: Path) -> None:
        """Replaces metadata.yaml in one step: a concurrent reader sees either the old file or the new one."""
        new = folder / f"{FILE}.new"
        new.write_text(_dump({"rosbag2_bagfile_information": self.information()}))
        new.replace(folder / FILE)


class _NoAliases(yaml.CSafeDumper):
    """Writes repeated values in full: some YAML readers do not support anchors."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _dump(data: dict[str, Any]) -> str:
    text: str = yaml.dump(data, Dumper=_NoAliases, sort_keys=False)
    return text

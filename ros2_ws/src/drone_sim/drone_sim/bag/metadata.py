"""metadata.yaml, which stands beside the messages of a bag and says what there is."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from rosbags.rosbag2.metadata import dump_qos_v9

from drone_sim.bag.storage import METADATA_VERSION, Topic

FILE = "metadata.yaml"


@dataclass
class Summary:
    """What a bag holds: its file, how many messages of which topic, and the first and the last time in ns."""

    storage: str
    file: str
    topics: list[Topic] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    messages: int = 0
    start: int = 0
    end: int = 0

    def count(self, index: int, time: int) -> None:
        """Takes note of a message of the topic at that index."""
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
        """The information as YAML, as rosbag2 also keeps it inside the file of messages."""
        return _dump(self.information())

    def save(self, folder: Path) -> None:
        """Writes metadata.yaml; whoever reads at the same time sees the old one or the new one, whole."""
        new = folder / f"{FILE}.new"
        new.write_text(_dump({"rosbag2_bagfile_information": self.information()}))
        new.replace(folder / FILE)


class _NoAliases(yaml.CSafeDumper):
    """Times stand twice in the file, and not every reader of YAML knows anchors."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _dump(data: dict[str, Any]) -> str:
    text: str = yaml.dump(data, Dumper=_NoAliases, sort_keys=False)
    return text

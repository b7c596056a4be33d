"""Output of all benchmarks: a table in the terminal and a JSON file under results/."""

import json
import os
import platform
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from bench import ROOT

RESULTS = ROOT / "bench" / "results"


@dataclass
class Row:
    """One measurement.

    ours, peers: values of this project and of other libraries, in `unit`; ratio: ours relative to the best peer, above
    1 is better for any unit; cpu, best: the values by CPU time and of the best round, by name; asked: the target as
    text; met: whether it is reached, None without a target; known: why a missed target is a known failure.
    """

    work: str
    unit: str
    ours: float
    asked: str = ""
    met: bool | None = None
    peers: dict[str, float] = field(default_factory=dict)
    ratio: float | None = None
    cpu: dict[str, float] = field(default_factory=dict)
    best: dict[str, float] = field(default_factory=dict)
    known: str = ""

    @property
    def failed(self) -> bool:
        """Whether a target is missed without a known reason."""
        return self.met is False and not self.known


def machine() -> dict[str, Any]:
    """Processor, number of cores, operating system and Python version, for the report."""
    names = [line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
             if line.startswith("model name")]
    return {"processor": names[0] if names else platform.processor(), "cores": os.cpu_count(),
            "system": platform.platform(), "python": platform.python_version()}


def report(name: str, settings: dict[str, Any], rows: list[Row]) -> None:
    """Prints the rows as a table and writes them to results/<name>.json."""
    table = Table(title=name)
    for title in ("work", "ours", "by CPU", "best", "unit", "peers", "ratio", "asked", "met"):
        table.add_column(title)
    for row in rows:
        peers = ", ".join(f"{peer} {value:.4g}" for peer, value in row.peers.items())
        met = {None: "", True: "yes", False: "known" if row.known else "no"}[row.met]
        ratio = f"{row.ratio:.2f}" if row.ratio else ""
        cpu, best = (f"{times['ours']:.4g}" if times else "" for times in (row.cpu, row.best))
        table.add_row(row.work, f"{row.ours:.4g}", cpu, best, row.unit, peers, ratio, row.asked, met)
    Console(width=170).print(table)
    RESULTS.mkdir(exist_ok=True)
    result = {"machine": machine(), "settings": settings, "rows": [asdict(row) for row in rows]}
    (RESULTS / f"{name}.json").write_text(json.dumps(result, indent=2) + "\n")

"""Draws a picture for each family of hard cases of collision.

    python -m figures.hard_cases.collision [NAME ...]
"""

import argparse
from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from figures import DOCS, style
from figures.hard_cases.collision import all_shapes, boxes, triangles

OUT = DOCS / "hard_cases"
CASES: dict[str, Callable[[], Figure]] = {
    "boxes_near_touch": boxes.near_touch,
    "boxes_parallel": boxes.parallel,
    "boxes_exact_touch": boxes.exact_touch,
    "boxes_thin": boxes.thin,
    "far_away": triangles.far_away,
    "triangles_coplanar": triangles.coplanar,
    "triangles_sharing_edge": triangles.sharing_edge,
    "triangles_sharing_vertex": triangles.sharing_vertex,
    "triangles_needles": triangles.needles,
    "triangles_zero_area": triangles.zero_area,
    "triangles_duplicates": triangles.duplicates,
    "levels_nested": all_shapes.levels_nested,
    "symmetry": all_shapes.symmetry,
    "grid": all_shapes.broad_phase,
}


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m figures.hard_cases.collision",
                                     description="Draws the hard cases of collision.")
    parser.add_argument("names", nargs="*", choices=[*CASES, []], metavar="NAME", help=f"which: {', '.join(CASES)}")
    parser.add_argument("--out", type=Path, default=OUT, help="folder to write to")
    options = parser.parse_args()
    for name in options.names or CASES:
        style.save(CASES[name](), options.out / f"{name}.png")
        print(options.out / f"{name}.png")


if __name__ == "__main__":
    main()

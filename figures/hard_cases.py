"""Draws a picture for each family of hard cases of collision: python figures/hard_cases.py [NAME ...]."""

import argparse
from collections.abc import Callable
from pathlib import Path

import box_cases
import space_cases
import style
import triangle_cases
from matplotlib.figure import Figure

OUT = Path(__file__).parents[1] / "docs" / "hard_cases"
CASES: dict[str, Callable[[], Figure]] = {
    "boxes_near_touch": box_cases.near_touch,
    "boxes_parallel": box_cases.parallel,
    "boxes_exact_touch": box_cases.exact_touch,
    "boxes_thin": box_cases.thin,
    "far_away": triangle_cases.far_away,
    "triangles_coplanar": triangle_cases.coplanar,
    "triangles_sharing_edge": triangle_cases.sharing_edge,
    "triangles_sharing_vertex": triangle_cases.sharing_vertex,
    "triangles_needles": triangle_cases.needles,
    "triangles_zero_area": triangle_cases.zero_area,
    "triangles_duplicates": triangle_cases.duplicates,
    "levels_nested": space_cases.levels_nested,
    "symmetry": space_cases.symmetry,
    "grid": space_cases.broad_phase,
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="hard_cases", description="Draws the hard cases of collision.")
    parser.add_argument("names", nargs="*", choices=[*CASES, []], metavar="NAME", help=f"which: {', '.join(CASES)}")
    parser.add_argument("--out", type=Path, default=OUT, help="folder to write to")
    options = parser.parse_args()
    for name in options.names or CASES:
        style.save(CASES[name](), options.out / f"{name}.png")
        print(options.out / f"{name}.png")


if __name__ == "__main__":
    main()

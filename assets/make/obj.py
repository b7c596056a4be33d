"""Writes models as Wavefront OBJ and MTL, the same bytes whenever the model is the same."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from make.materials import MATERIALS, Material
from make.shapes import Array, Part, normals


def write_model(name: str, model: Sequence[Part], folder: Path) -> int:
    """Writes <name>.obj and <name>.mtl; returns how many triangles they hold."""
    used = sorted({part.material for part in model})
    (folder / f"{name}.mtl").write_text("\n".join(_material(key, MATERIALS[key]) for key in used))
    parts = {key: [part for part in model if part.material == key] for key in used}
    corners = {key: np.concatenate([part.corners for part in parts[key]]) for key in used}
    coordinates = {key: np.concatenate([part.uv for part in parts[key]]) / MATERIALS[key].tile for key in used}
    directions = {key: np.concatenate([normals(part) for part in parts[key]]) for key in used}
    lines = [f"# {name}: metres, x forward, z up", f"mtllib {name}.mtl"]
    indices = []
    for word, values, decimals in (("v", corners, 4), ("vt", coordinates, 3), ("vn", directions, 3)):
        rows, index = _distinct(
            np.concatenate([values[key].reshape(-1, values[key].shape[-1]) for key in used]), decimals
        )
        lines += [f"{word} " + " ".join(f"{number:.{decimals}f}" for number in row) for row in rows]
        indices.append(index + 1)
    faces = np.stack(indices, axis=1).reshape(-1, 3, 3)
    start = 0
    for key in used:
        lines.append(f"usemtl {key}")
        for face in faces[start : start + len(corners[key])]:
            lines.append("f " + " ".join("/".join(map(str, corner)) for corner in face))
        start += len(corners[key])
    (folder / f"{name}.obj").write_text("\n".join(lines) + "\n")
    return len(faces)


def _distinct(values: Array, decimals: int) -> tuple[Array, np.ndarray]:
    """The different rows among rounded values, and which of them each value is."""
    rows, index = np.unique(np.round(values, decimals) + 0.0, axis=0, return_inverse=True)
    return rows, index.ravel()


def _material(name: str, material: Material) -> str:
    """One 'newmtl' of the MTL file."""

    def numbers(values: Sequence[float]) -> str:
        return " ".join(f"{value:.3f}" for value in values)

    lines = [
        f"newmtl {name}",
        f"Kd {numbers(material.colour)}",
        f"Ks {numbers([material.specular] * 3)}",
        f"Ns {material.shininess:.1f}",
    ]
    if any(material.emission):
        lines.append(f"Ke {numbers(material.emission)}")
    if material.texture:
        lines.append(f"map_Kd ../textures/{material.texture}.png")
        lines.append(f"norm ../textures/{material.texture}_normal.png")
    return "\n".join(lines) + "\n"

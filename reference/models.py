"""A small model with two materials, for the tests."""

from pathlib import Path

from PIL import Image

OBJ = """mtllib box.mtl
v 0 0 0
v 2 0 0
v 2 1 0
v 0 1 -3
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
usemtl wood
f 1/1/1 2/2/1 3/3/1
usemtl screen
f 1/1/1 3/3/1 4/4/1
"""
MTL = """newmtl wood
Kd 0.5 0.4 0.3
Ks 0.1 0.2 0.3
Ns 64
map_Kd wood.png
norm bumps.png
newmtl screen
Ke 0.2 0.4 0.9
"""


def write_model(folder: Path, obj: str = OBJ, mtl: str | None = MTL) -> Path:
    """Writes box.obj, box.mtl (unless None) and their textures into a folder; returns the path of the OBJ."""
    if mtl is not None:
        (folder / "box.mtl").write_text(mtl)
    for name in ("wood.png", "bumps.png"):
        Image.new("RGB", (2, 2)).save(folder / name)
    (folder / "box.obj").write_text(obj)
    return folder / "box.obj"

"""Models on the device: parts with the same look, cut into pieces, each with several levels of detail."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from drone_engine.arrays import Booleans, Floats
from drone_engine.geometry.mesh import Material, Model, Part
from drone_engine.scene.picture import Render
from drone_render.arrays import Faces, Float32s
from drone_render.frame.lighting import Lighting
from drone_render.gl.device import Attribute, Device
from drone_render.gl.instances import Instances
from drone_render.gl.uniforms import packed, set_samplers, setter
from drone_render.gl.variant import Variant
from drone_render.models import lod
from drone_render.models.textures import pack
from drone_render.models.vertices import bounds, tangents

MIN_SPECULAR = 0.1  # highlights that reflect less are invisible, and are not computed
WIDE = 10.0  # m; surfaces that extend further from their center are cut into blocks, each with its own level of detail


class Look(NamedTuple):
    """The properties of a material that select the program and textures; colors are vertex attributes."""

    color_map: Path | None
    normal_map: Path | None
    squarings: int | None  # exponent of the highlight, as a number of squarings; None without highlights

    @classmethod
    def of(cls, material: Material, render: Render) -> "Look":
        """The look of a material with the features that the scene enables."""
        shines = render.specular is not None and max(material.specular) >= MIN_SPECULAR
        return cls(
            material.color_map,
            material.normal_map if render.normal_mapping is not None else None,
            squarings(material.shininess) if shines else None,
        )


def squarings(shininess: float) -> int:
    """Number of squarings of the cosine to the reflected light that looks like Blinn's highlight with this exponent."""
    return int(np.clip(round(math.log2(max(shininess, 1.0) / 4)), 1, 6))


class Maps:
    """The textures of a look: none, a color map, a normal map, or both, packed into one texture where possible."""

    def __init__(self, device: Device, look: Look) -> None:
        packed_map = pack(look.color_map, look.normal_map) if look.color_map and look.normal_map else None
        self.uniforms: dict[str, bytes] = {}
        """Uniforms that decode the textures, packed."""
        if packed_map is not None:  # one fetch instead of two: a fetch costs as much as three lights
            self.textures = {"color_normal_map": device.packed_texture(packed_map)}
            self.uniforms = {"ramp": packed(packed_map.ramp), "steepness": packed(packed_map.steepness)}
        else:
            paths = {"color_map": look.color_map, "normal_map": look.normal_map}
            self.textures = {name: device.texture(path) for name, path in paths.items() if path is not None}

    def use(self) -> None:
        """Binds the textures to units 0, 1, ... in their order."""
        for unit, texture in enumerate(self.textures.values()):
            texture.use(unit)


class Level(NamedTuple):
    """A level of detail of a piece: its range in the index buffer, and its error in m."""

    first: int
    indices: int
    error: float


class Piece(NamedTuple):
    """The unit of culling and of levels of detail: a surface, or a block of a wide one. In the model's frame."""

    surface: "Surface"
    center: Floats  # (3,) m, of its bounding box
    half: Floats  # (3,) m, half extents of the box
    radius: float  # m, of the bounding sphere about the center
    levels: Sequence[Level]  # the full one first


class Draw(NamedTuple):
    """A surface with one of its programs: vertex array, uniforms of the maps, and setter of the lights, if any."""

    program: moderngl.Program
    array: moderngl.VertexArray
    uniforms: Sequence[tuple[Callable[[bytes], object], bytes]]
    lights: Callable[[bytes], object] | None


class Shared(NamedTuple):
    """Settings of all surfaces of a scene: instance buffers; whether there are a sun, beams, and antialiasing."""

    instances: Instances
    sun: bool
    beams: bool
    edges: bool


class Surface:
    """The parts of a model that have one look, on the device, and a program for each number of lights."""

    def __init__(self, device: Device, look: Look, maps: Maps, shared: Shared, parts: list[Part]) -> None:
        self._device, self._look, self.maps, self._shared = device, look, maps, shared
        self._emissive = any(any(part.material.emission) for part in parts)
        columns: dict[str, list[npt.NDArray[np.floating]]] = {
            "position": [part.vertices for part in parts],
            "normal": [part.normals for part in parts],
            "uv": [part.uv for part in parts],
            "color": [_repeated(part, part.material.color) for part in parts],
        }
        if look.squarings is not None:
            columns["specular"] = [_repeated(part, part.material.specular) for part in parts]
        if self._emissive:
            columns["emission"] = [_repeated(part, part.material.emission) for part in parts]
        if look.normal_map is not None:
            columns["tangent"] = [tangents(part) for part in parts]
        self._vertices = {name: np.vstack(rows).astype(np.float32) for name, rows in columns.items()}
        first = np.cumsum([0] + [len(part.vertices) for part in parts])
        faces = np.vstack([part.faces + start for part, start in zip(parts, first, strict=False)]).astype(np.int32)
        wide = float(np.ptp(self.position, axis=0).max()) > 2 * WIDE
        self.blocks = [faces[block] for block in lod.blocks(self.position, faces)] if wide else [faces]
        """Faces (m, 3) of each piece, until they are uploaded."""
        self._attributes: list[Attribute] = []
        self._index: moderngl.Buffer | None = None
        self._draws: dict[int, Draw] = {}
        self._shapes: dict[moderngl.Program, moderngl.VertexArray] = {}

    @property
    def position(self) -> Float32s:
        """Vertices (n, 3) in the model's frame, until they are uploaded."""
        return self._vertices["position"]

    def upload(self, kept: Booleans) -> list[Piece]:
        """Moves all levels of detail to the device; kept: (n,) vertices that every level keeps (pieces join there)."""
        pieces: list[Piece] = []
        index: list[Faces] = []
        first = 0
        for faces in self.blocks:
            used, own = np.unique(faces, return_inverse=True)
            rows = {name: self._vertices[name][used].astype(np.float64) for name in ("position", "normal", "uv")}
            found = lod.levels(**rows, faces=own.reshape(-1, 3).astype(np.int32), kept=kept[used])
            levels = []
            for triangles, error in found:
                index.append(used[triangles].astype(np.int32))
                levels.append(Level(first, triangles.size, error))
                first += triangles.size
            pieces.append(Piece(self, *bounds(self.position[used]), levels))
        if not self.maps.textures:
            del self._vertices["uv"]
        self._attributes = [
            (self._device.buffer(rows), f"{rows.shape[1]}f", name) for name, rows in self._vertices.items()
        ]
        self._index = self._device.buffer(np.vstack(index))
        self._vertices.clear()
        self.blocks.clear()
        return pieces

    def variant(self, lights: int) -> Variant:
        """The program variant for a number of lights."""
        maps = {name.upper(): True for name in self.maps.textures}
        return Variant.of(
            "solid", LIGHTS=lights, SUN=self._shared.sun, BEAMS=self._shared.beams, EDGES=self._shared.edges,
            UV=bool(maps), BUMPS=self._look.normal_map is not None, EMISSIVE=self._emissive,
            SPECULAR=self._look.squarings or False, **maps,
        )  # fmt: skip

    def draw(self, lights: int) -> Draw:
        """The surface with the program for a number of lights."""
        if lights not in self._draws:
            program = self._device.program(self.variant(lights))
            set_samplers(program, **{name: unit for unit, name in enumerate(self.maps.textures)})
            uniforms = [(put, value) for name, value in self.maps.uniforms.items() if (put := setter(program, name))]
            self._draws[lights] = Draw(program, self.shape(program), uniforms, setter(program, "lights"))
        return self._draws[lights]

    def shape(self, program: moderngl.Program) -> moderngl.VertexArray:
        """The surface's triangles with the attributes that a program uses."""
        if program not in self._shapes:
            attributes = self._attributes + self._shared.instances.attributes
            self._shapes[program] = self._device.vertex_array(program, attributes, self._index)
        return self._shapes[program]


class Surfaces:
    """The surfaces of all models on the device; models and pairs of maps are uploaded once."""

    def __init__(self, device: Device, render: Render, lighting: Lighting, instances: Instances) -> None:
        self._device, self._render = device, render
        self._shared = Shared(instances, lighting.sun is not None, lighting.beams, render.antialiasing is not None)
        self._maps: dict[tuple[Path | None, Path | None], Maps] = {}
        self._pieces: dict[Path, list[Piece]] = {}

    def pieces(self, model: Model) -> list[Piece]:
        """The pieces of a model."""
        if model.path not in self._pieces:
            self._pieces[model.path] = self._upload(model)
        return self._pieces[model.path]

    def _upload(self, model: Model) -> list[Piece]:
        looks: dict[Look, list[Part]] = {}
        for part in model.parts:
            looks.setdefault(Look.of(part.material, self._render), []).append(part)
        surfaces = []
        for look, parts in looks.items():
            if look[:2] not in self._maps:
                self._maps[look[:2]] = Maps(self._device, look)
            surfaces.append(Surface(self._device, look, self._maps[look[:2]], self._shared, parts))
        # Vertices shared by several pieces are kept at all levels: else gaps would open between levels.
        corners = [surface.position[np.unique(faces)] for surface in surfaces for faces in surface.blocks]
        places, owners = np.unique(np.vstack([np.unique(each, axis=0) for each in corners]), axis=0, return_counts=True)
        seams = {place.tobytes() for place in places[owners > 1]}
        return [
            piece
            for surface in surfaces
            for piece in surface.upload(np.array([place.tobytes() in seams for place in surface.position]))
        ]


def _repeated(part: Part, values: tuple[float, float, float]) -> Floats:
    """The values for each vertex of a part, (n, 3)."""
    return np.tile(values, (len(part.vertices), 1))

"""Models on the device: parts that look alike, cut into pieces, each at several levels of detail."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from drone_engine.geometry.mesh import Material, Model, Part
from drone_engine.scene.picture import Render
from drone_render import detail
from drone_render.context import Attribute, Device, packed, samplers, setter
from drone_render.geometry import bounds, pack, tangents
from drone_render.hierarchy import Lighting
from drone_render.instances import Instances
from drone_render.shaders import Variant
from drone_render.view import Array

FAINT = 0.1  # a highlight that reflects less is not seen, so it is not computed
WIDE = 10.0  # m; what reaches further may be near at one end and far away at the other, so it is cut into blocks


class Look(NamedTuple):
    """What parts of a model have in common that are drawn at once; their colours are in their vertices."""

    colour_map: Path | None
    normal_map: Path | None
    squarings: int | None  # None: without highlights

    @classmethod
    def of(cls, material: Material, render: Render) -> "Look":
        """How a material looks with what the scene asks for."""
        shines = render.specular is not None and max(material.specular) >= FAINT
        return cls(
            material.color_map,
            material.normal_map if render.normal_mapping is not None else None,
            squarings(material.shininess) if shines else None,
        )


def squarings(shininess: float) -> int:
    """How often to square the cosine to the mirrored light so that it looks like Blinn's with this exponent."""
    return int(np.clip(round(math.log2(max(shininess, 1.0) / 4)), 1, 6))


class Maps:
    """The textures of a look on the device: none, a colour map, a normal map, or both, packed into one if possible."""

    def __init__(self, device: Device, look: Look) -> None:
        packed_map = pack(look.colour_map, look.normal_map) if look.colour_map and look.normal_map else None
        self.uniforms: dict[str, bytes] = {}
        """What programs need beside them, packed."""
        if packed_map is not None:  # one fetch instead of two: a fetch costs as much as three lights
            self.textures = {"colour_normal_map": device.packed_texture(packed_map)}
            self.uniforms = {"ramp": packed(packed_map.ramp), "steepness": packed(packed_map.steepness)}
        else:
            paths = {"colour_map": look.colour_map, "normal_map": look.normal_map}
            self.textures = {name: device.texture(path) for name, path in paths.items() if path is not None}

    def use(self) -> None:
        """Makes them the ones that programs fetch from."""
        for unit, texture in enumerate(self.textures.values()):
            texture.use(unit)


class Level(NamedTuple):
    """Where a piece's triangles lie in the index, and how far they are off, in m."""

    first: int
    corners: int
    error: float


class Piece(NamedTuple):
    """What is drawn at once: all of a surface, or a block of a wide one. The middle of its box, half the box's edges,
    and the radius of a sphere about the middle, in the model's frame; the levels of detail, the full one first."""

    surface: "Surface"
    middle: Array
    half: Array
    radius: float
    levels: Sequence[Level]


class Draw(NamedTuple):
    """A surface as a program draws it: what to set for the surface's maps, and what sets the program's lights, if it
    has any."""

    program: moderngl.Program
    array: moderngl.VertexArray
    uniforms: Sequence[tuple[Callable[[bytes], object], bytes]]
    lights: Callable[[bytes], object] | None


class Shared(NamedTuple):
    """What all programs of a scene have in common: where things are, rays of the sun, beams, marks for smooth edges."""

    instances: Instances
    sun: bool
    beams: bool
    edges: bool


class Surface:
    """Parts of a model that look alike, on the device, and the programs that draw them: one per number of lights."""

    def __init__(self, device: Device, look: Look, maps: Maps, shared: Shared, parts: list[Part]) -> None:
        self._device, self._look, self.maps, self._shared = device, look, maps, shared
        self._glows = any(any(part.material.emission) for part in parts)
        columns: dict[str, list[npt.NDArray[np.floating]]] = {
            "position": [part.vertices for part in parts],
            "normal": [part.normals for part in parts],
            "uv": [part.uv for part in parts],
            "colour": [_each(part, part.material.color) for part in parts],
        }
        if look.squarings is not None:
            columns["specular"] = [_each(part, part.material.specular) for part in parts]
        if self._glows:
            columns["emission"] = [_each(part, part.material.emission) for part in parts]
        if look.normal_map is not None:
            columns["tangent"] = [tangents(part) for part in parts]
        self._vertices = {name: np.vstack(rows).astype(np.float32) for name, rows in columns.items()}
        first = np.cumsum([0] + [len(part.vertices) for part in parts])
        faces = np.vstack([part.faces + start for part, start in zip(parts, first, strict=False)]).astype(np.int32)
        wide = float(np.ptp(self.position, axis=0).max()) > 2 * WIDE
        self.blocks = [faces[block] for block in detail.blocks(self.position, faces)] if wide else [faces]
        self._attributes: list[Attribute] = []
        self._index: moderngl.Buffer | None = None
        self._draws: dict[int, Draw] = {}
        self._shapes: dict[moderngl.Program, moderngl.VertexArray] = {}

    @property
    def position(self) -> npt.NDArray[np.float32]:
        """Of its vertices (n, 3), in the model's frame, until they are on the device."""
        return self._vertices["position"]

    def upload(self, kept: npt.NDArray[np.bool_]) -> list[Piece]:
        """Puts all levels on the device, and leaves nothing here; `kept` (n,): vertices that no level may leave out, as
        others end there, too."""
        pieces: list[Piece] = []
        index: list[npt.NDArray[np.int32]] = []
        first = 0
        for faces in self.blocks:
            used, own = np.unique(faces, return_inverse=True)
            rows = {name: self._vertices[name][used].astype(np.float64) for name in ("position", "normal", "uv")}
            found = detail.levels(**rows, faces=own.reshape(-1, 3).astype(np.int32), kept=kept[used])
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
        """The program that draws this with so many lights."""
        maps = {name.upper(): True for name in self.maps.textures}
        return Variant.of(
            "solid", LIGHTS=lights, SUN=self._shared.sun, BEAMS=self._shared.beams, EDGES=self._shared.edges,
            UV=bool(maps), BUMPS=self._look.normal_map is not None, EMISSIVE=self._glows,
            SPECULAR=self._look.squarings or False, **maps,
        )  # fmt: skip

    def draw(self, lights: int) -> Draw:
        """How to draw it with so many lights."""
        if lights not in self._draws:
            program = self._device.program(self.variant(lights))
            samplers(program, **{name: unit for unit, name in enumerate(self.maps.textures)})
            uniforms = [(put, value) for name, value in self.maps.uniforms.items() if (put := setter(program, name))]
            self._draws[lights] = Draw(program, self.shape(program), uniforms, setter(program, "lights"))
        return self._draws[lights]

    def shape(self, program: moderngl.Program) -> moderngl.VertexArray:
        """Its triangles, with what a program takes of them."""
        if program not in self._shapes:
            attributes = self._attributes + self._shared.instances.attributes
            self._shapes[program] = self._device.vertex_array(program, attributes, self._index)
        return self._shapes[program]


class Surfaces:
    """The surfaces of models on the device, each model's and each pair of maps once."""

    def __init__(self, device: Device, render: Render, lighting: Lighting, instances: Instances) -> None:
        self._device, self._render = device, render
        self._shared = Shared(instances, lighting.sun is not None, lighting.beams, render.antialiasing is not None)
        self._maps: dict[tuple[Path | None, Path | None], Maps] = {}
        self._pieces: dict[Path, list[Piece]] = {}

    def pieces(self, model: Model) -> list[Piece]:
        """What a model is drawn by."""
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
        # Where pieces meet, vertices stay: if one gave them up at a level and the other not, a gap would open.
        corners = [surface.position[np.unique(faces)] for surface in surfaces for faces in surface.blocks]
        places, owners = np.unique(np.vstack([np.unique(each, axis=0) for each in corners]), axis=0, return_counts=True)
        seams = {place.tobytes() for place in places[owners > 1]}
        return [
            piece
            for surface in surfaces
            for piece in surface.upload(np.array([place.tobytes() in seams for place in surface.position]))
        ]


def _each(part: Part, values: tuple[float, float, float]) -> Array:
    return np.tile(values, (len(part.vertices), 1))

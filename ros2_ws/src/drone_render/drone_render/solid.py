"""Solid things: which of them are seen, by which lights, and how they are drawn."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from drone_render import view
from drone_render.context import Device, packed, write
from drone_render.geometry import pack, sphere, tangents
from drone_render.hierarchy import LIGHTS, Lighting
from drone_render.passes import Frame
from drone_render.shaders import Variant
from drone_render.view import Array
from drone_sim.look import Render
from drone_sim.mesh import Material, Model, Part

FAINT = 0.1  # a highlight that reflects less is not seen, so it is not computed


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
            material.colour_map,
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
        self.ramp = None if packed_map is None else packed(packed_map.ramp)
        if packed_map is not None:  # one fetch instead of two: a fetch costs as much as three lights
            self.textures = {"colour_normal_map": device.packed_texture(packed_map)}
        else:
            paths = {"colour_map": look.colour_map, "normal_map": look.normal_map}
            self.textures = {name: device.texture(path) for name, path in paths.items() if path is not None}

    def use(self, program: moderngl.Program) -> None:
        """Makes them the ones that the program fetches from."""
        for unit, texture in enumerate(self.textures.values()):
            texture.use(unit)
        if self.ramp is not None:
            program["ramp"].write(self.ramp)  # type: ignore[union-attr]


class Surface:
    """Parts of a model that look alike, on the device, and the programs that draw them: one per number of lights."""

    def __init__(self, device: Device, look: Look, maps: Maps, sun: bool, parts: list[Part]) -> None:
        self._device, self._look, self.maps, self._sun = device, look, maps, sun
        self._glows = any(any(part.material.emission) for part in parts)
        self.centre, self.radius = sphere([part.vertices for part in parts])
        columns: dict[str, list[npt.NDArray[np.floating]]] = {
            "position": [part.vertices for part in parts],
            "normal": [part.normals for part in parts],
            "colour": [_each(part, part.material.colour) for part in parts],
            "specular": [_each(part, part.material.specular) for part in parts],
            "emission": [_each(part, part.material.emission) for part in parts],
            "uv": [part.uv for part in parts],
            "tangent": [tangents(part) for part in parts] if look.normal_map else [],
        }
        vertices = {name: np.vstack(rows).astype(np.float32) for name, rows in columns.items() if rows}
        self._attributes = [(device.buffer(rows), f"{rows.shape[1]}f", name) for name, rows in vertices.items()]
        first = np.cumsum([0] + [len(part.vertices) for part in parts])
        self._index = device.buffer(
            np.vstack([part.faces + start for part, start in zip(parts, first, strict=False)]).astype(np.int32)
        )
        self._arrays: dict[int, moderngl.VertexArray] = {}

    def variant(self, lights: int) -> Variant:
        """The program that draws this with so many lights."""
        maps = {name.upper(): True for name in self.maps.textures}
        return Variant.of(
            "solid", LIGHTS=lights, SUN=self._sun, UV=bool(maps), BUMPS=self._look.normal_map is not None,
            EMISSIVE=self._glows, SPECULAR=self._look.squarings or False, **maps,
        )  # fmt: skip

    def array(self, lights: int) -> moderngl.VertexArray:
        """What to draw with so many lights."""
        if lights not in self._arrays:
            program = self._device.program(self.variant(lights))
            for unit, name in enumerate(self.maps.textures):
                program[name] = unit
            self._arrays[lights] = self._device.vertex_array(program, self._attributes, self._index)
        return self._arrays[lights]


def _looks(model: Model, render: Render) -> dict[Look, list[Part]]:
    looks: dict[Look, list[Part]] = {}
    for part in model.parts:
        looks.setdefault(Look.of(part.material, render), []).append(part)
    return looks


def _each(part: Part, values: tuple[float, float, float]) -> Array:
    return np.tile(values, (len(part.vertices), 1))


class SolidPass:
    """All that is neither water nor sky; models by their object's row in the scene. Equal models are there once."""

    def __init__(self, device: Device, render: Render, models: Mapping[int, Model], lighting: Lighting) -> None:
        self._ambient = render.ambient
        self._lighting = lighting
        maps: dict[tuple[Path | None, Path | None], Maps] = {}
        made: dict[Path, list[Surface]] = {}
        for model in models.values():
            if model.path not in made:
                made[model.path] = []
                for look, parts in _looks(model, render).items():
                    if look[:2] not in maps:
                        maps[look[:2]] = Maps(device, look)
                    sun = lighting.parallel is not None
                    made[model.path].append(Surface(device, look, maps[look[:2]], sun, parts))
        pairs = [(row, surface) for row, model in models.items() for surface in made[model.path]]
        # Drawing in this order changes programs and textures least, which costs the driver more than a draw.
        pairs.sort(key=lambda pair: (str(sorted(pair[1].variant(0).defines)), id(pair[1].maps), pair[0]))
        self._surfaces = [surface for _, surface in pairs]
        self._rows = np.array([row for row, _ in pairs], dtype=np.intp)
        self._centres = np.array([surface.centre for surface in self._surfaces]).reshape(-1, 3)
        self._radii = np.array([surface.radius for surface in self._surfaces])

    def warm_up(self) -> None:
        """Draws with every program that can occur: the driver compiles each at its first use, which takes a while."""
        parallel = self._lighting.parallel is not None
        seen: set[Variant] = set()
        for surface, row in zip(self._surfaces, self._rows, strict=True):
            for count in range(min(int(self._lighting.lit[row].sum()) - parallel, LIGHTS) + 1):
                if surface.variant(count) not in seen:
                    seen.add(surface.variant(count))
                    array = surface.array(count)
                    write(array.program, view_projection=np.eye(4), model=np.eye(4))
                    surface.maps.use(array.program)
                    array.render()

    def draw(self, frame: Frame, world: Array) -> None:
        """Draws what the camera sees of the objects at their matrices (n, 4, 4)."""
        places = world[self._rows]
        centres = np.einsum("nij,nj->ni", places[:, :3, :3], self._centres) + places[:, :3, 3]
        planes = view.frustum(frame.view_projection)
        seen = np.flatnonzero((centres @ planes[:, :3].T + planes[:, 3] > -self._radii[:, None]).all(axis=1))
        # What is near hides the most; what surrounds the camera, such as the ground, comes after it.
        around = np.linalg.norm(centres[seen] - frame.eye, axis=1) <= self._radii[seen]
        seen = np.concatenate([seen[~around], seen[around]])

        lighting = self._lighting
        positions = lighting.positions(world)
        lights = np.column_stack([positions, lighting.falloff, lighting.colours, lighting.cut]).astype(np.float32)
        chosen = lighting.strongest(positions, self._rows[seen], centres[seen], self._radii[seen])
        matrices = np.ascontiguousarray(places[seen].transpose(0, 2, 1), dtype=np.float32)
        shared: dict[str, npt.ArrayLike] = {"ambient": self._ambient, "eye": frame.eye, **frame.sun_uniforms()}
        shared["view_projection"] = frame.view_projection.T
        uniforms = {name: packed(value) for name, value in shared.items()}
        begun: set[moderngl.Program] = set()
        used: tuple[moderngl.Program, Maps] | None = None
        for i, matrix, numbers in zip(seen.tolist(), matrices, chosen, strict=True):
            surface = self._surfaces[i]
            array = surface.array(len(numbers))
            program = array.program
            if program not in begun:
                begun.add(program)
                write(program, **uniforms)
            if used != (program, surface.maps):
                used = program, surface.maps
                surface.maps.use(program)
            program["model"].write(matrix)  # type: ignore[union-attr]
            if numbers:
                program["lights"].write(lights[list(numbers)])  # type: ignore[union-attr]
            array.render()

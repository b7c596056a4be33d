"""A scene as arrays: sizes, masses and moments of inertia."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drone_engine import Scene, SceneError, model
from drone_engine.geometry.mass_properties import moments


def card(scene: Callable[..., Scene], name: str, thickness: str, rest: str) -> Scene:
    """A scene with one body of 1 m by 1 m and some thickness."""
    models = Path(scene("crate: {model: crate, mass: 1}").path).parent.parent / "models"
    (models / f"{name}.obj").write_text(f"v 0 0 0\nv 1 0 0\nv 1 1 {thickness}\nf 1 2 3\n")
    return scene(f"crate: {{model: crate, mass: 1}}\ncard: {{model: {name}, {rest}}}")


def test_mass_and_box_make_the_inertia(scene: Callable[..., Scene]) -> None:
    bodies = model.build(scene("crate: {model: crate, mass: 6}")).bodies
    np.testing.assert_allclose(bodies.half, [[0.3, 0.3, 0.3]])
    np.testing.assert_allclose(bodies.inertia_b, [[0.36, 0.36, 0.36]])  # m a^2 / 6 of a cube


@pytest.mark.parametrize("thickness", ["0", "1e-200", "1e200"])
def test_a_moving_body_needs_a_volume(scene: Callable[..., Scene], thickness: str) -> None:
    flat = card(scene, f"card_{thickness.replace('-', '_')}", thickness, "mass: 1")
    with pytest.raises(SceneError) as error:
        model.build(flat)
    assert str(error.value).startswith(f"{flat.path}: objects.card.model: ")
    assert f"got 1 x 1 x {float(thickness):g} m" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_static_body_may_be_flat(scene: Callable[..., Scene]) -> None:
    assert model.build(card(scene, "flat_card", "0", "static: true")).bodies.half[1, 2] == 0.0


def test_moments_of_inertia_of_solids_match_closed_forms(tmp_path: Path) -> None:
    corner = tmp_path / "corner.obj"  # a tetrahedron: by the second moments 1/10 and the center 1/4, 2 (1/10 - 1/16)
    corner.write_text("v 3 0 0\nv 4 0 0\nv 3 1 0\nv 3 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    np.testing.assert_allclose(moments(corner), 0.075)
    prism = tmp_path / "prism.obj"  # six sides, radius 1, height 2: 5 / 24 R^2 in its plane
    ring = [(np.cos(k * np.pi / 3), np.sin(k * np.pi / 3)) for k in range(6)]
    text = "".join(f"v {x} {y} {z}\n" for z in (-1, 1) for x, y in ring)
    text += "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n"
    text += "".join(f"f {k + 1} {(k + 1) % 6 + 1} {(k + 1) % 6 + 7} {k + 7}\n" for k in range(6))
    prism.write_text(text)
    np.testing.assert_allclose(moments(prism), [5 / 24 + 1 / 3, 5 / 24 + 1 / 3, 10 / 24])


def test_an_open_surface_counts_as_its_box(tmp_path: Path) -> None:
    bowl = tmp_path / "bowl.obj"
    bowl.write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\n")
    np.testing.assert_allclose(moments(bowl), [13 / 12, 10 / 12, 5 / 12])

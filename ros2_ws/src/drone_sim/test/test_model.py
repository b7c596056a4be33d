"""A scene as arrays: what can move, and what cannot."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drone_sim import model
from drone_sim.scene import Scene, SceneError


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
def test_what_moves_needs_a_volume(scene: Callable[..., Scene], thickness: str) -> None:
    flat = card(scene, f"card_{thickness.replace('-', '_')}", thickness, "mass: 1")
    with pytest.raises(SceneError) as error:
        model.build(flat)
    assert str(error.value).startswith(f"{flat.path}: objects.card.model: ")
    assert f"got 1 x 1 x {float(thickness):g} m" in str(error.value)
    assert "\n" not in str(error.value)


def test_what_stands_may_be_flat(scene: Callable[..., Scene]) -> None:
    assert model.build(card(scene, "flat_card", "0", "static: true")).bodies.half[1, 2] == 0.0

"""What the models are made of."""

from dataclasses import dataclass

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Material:
    """Colours as Wavefront MTL means them. A texture, with its normal map, covers `tile` metres."""

    colour: Colour = (1.0, 1.0, 1.0)
    specular: float = 0.05
    shininess: float = 16.0
    emission: Colour = (0.0, 0.0, 0.0)
    texture: str | None = None
    tile: float = 1.0  # 1 also for models that give texture coordinates from 0 to 1


MATERIALS = {
    # drones
    "shell": Material((0.47, 0.56, 0.64), 0.40, 32, texture="panels", tile=0.12),
    "shell_dark": Material((0.20, 0.21, 0.25), 0.22, 32, texture="weave", tile=0.06),
    "accent": Material((0.84, 0.31, 0.05), 0.30, 32, texture="enamel", tile=0.10),
    "carbon": Material((0.22, 0.23, 0.26), 0.22, 32, texture="weave", tile=0.06),
    "lens": Material((0.55, 0.65, 0.85), 0.7, 60, texture="glass"),
    "light_red": Material((1.0, 0.16, 0.10), 0.3, 60, emission=(1.0, 0.25, 0.15), texture="glass"),
    "light_green": Material((0.14, 1.0, 0.30), 0.3, 60, emission=(0.2, 1.0, 0.3), texture="glass"),
    "light_white": Material((1.0, 1.0, 0.95), 0.4, 60, emission=(0.9, 0.87, 0.76), texture="glass"),
    "blade": Material((0.22, 0.23, 0.27), 0.22, 32, texture="weave", tile=0.05),
    "blade_tip": Material((0.86, 0.40, 0.07), 0.30, 32, texture="enamel", tile=0.08),
    "wood": Material((1.0, 0.96, 0.90), 0.18, 24, texture="wood", tile=0.30),
    "wood_dark": Material((0.58, 0.46, 0.38), 0.18, 24, texture="wood", tile=0.25),
    "wood_light": Material((1.0, 1.0, 0.98), 0.2, 24, texture="wood", tile=0.22),
    "brass": Material((0.72, 0.55, 0.22), 0.6, 60, texture="metal", tile=0.2),
    "steel": Material((0.60, 0.62, 0.65), 0.5, 60, texture="metal", tile=0.4),
    # person
    "skin": Material((1.0, 1.0, 1.0), 0.10, 16, texture="face"),
    "hair": Material((0.24, 0.14, 0.09), 0.15, 20, texture="hair", tile=0.06),
    "jacket": Material((0.15, 0.38, 0.58), 0.04, 8, texture="fabric", tile=0.16),
    "cap": Material((0.80, 0.30, 0.06), 0.04, 8, texture="fabric", tile=0.16),
    "jeans": Material((0.20, 0.25, 0.40), 0.03, 8, texture="fabric", tile=0.16),
    "shoes": Material((0.62, 0.16, 0.12), 0.05, 8, texture="fabric", tile=0.16),
    "sole": Material((0.74, 0.73, 0.69), 0.05, 8, texture="fabric", tile=0.16),
    # things
    "plastic": Material((0.11, 0.11, 0.12), 0.3, 32, texture="enamel", tile=0.15),
    "plastic_grey": Material((0.50, 0.50, 0.48), 0.25, 32, texture="enamel", tile=0.15),
    "chrome": Material((0.66, 0.68, 0.71), 0.8, 60, texture="metal", tile=0.5),
    "cabinet": Material((0.62, 0.45, 0.33), 0.25, 28, texture="wood", tile=0.4),
    "screen": Material((0.75, 0.75, 0.78), 0.5, 60, emission=(0.75, 0.80, 0.90), texture="test_card"),
    "crate": Material((0.95, 0.85, 0.70), 0.05, 10, texture="planks", tile=0.8),
    "rubber": Material((0.085, 0.085, 0.09), 0.1, 12, texture="enamel", tile=0.2),
    "paint_red": Material((0.62, 0.12, 0.09), 0.40, 32, texture="enamel", tile=0.5),
    "paint_cream": Material((0.74, 0.71, 0.62), 0.30, 32, texture="enamel", tile=0.5),
    "glass": Material((1.0, 1.0, 1.0), 0.8, 60, texture="glass"),
    "glass_lit": Material((1.0, 1.0, 1.0), 0.5, 60, emission=(0.75, 0.62, 0.42), texture="glass"),
    "lamp": Material((0.9, 0.86, 0.74), 0.8, 60, emission=(0.45, 0.38, 0.22), texture="glass"),
    # buildings
    "bricks": Material(specular=0.03, texture="bricks", tile=1.2),
    "roof_tiles": Material(specular=0.06, texture="roof_tiles", tile=1.6),
    "roof_slate": Material((0.52, 0.60, 0.72), 0.08, 16, texture="roof_tiles", tile=1.6),
    "plaster": Material((0.98, 0.95, 0.88), 0.02, texture="plaster", tile=2.0),
    "plaster_red": Material((0.83, 0.20, 0.16), 0.04, texture="plaster", tile=2.0),
    "planks": Material((0.86, 0.42, 0.34), 0.03, texture="planks", tile=1.6),
    "trim": Material((0.80, 0.79, 0.76), 0.08, 16, texture="enamel", tile=0.5),
    "door": Material((0.25, 0.48, 0.46), 0.15, 20, texture="planks", tile=0.8),
    "stone": Material((0.92, 0.91, 0.88), 0.04, texture="rock", tile=2.0),
    "concrete": Material((0.62, 0.63, 0.64), 0.05, texture="concrete", tile=4.0),
    "floor_line": Material((0.90, 0.68, 0.14), 0.05, texture="concrete", tile=4.0),
    # nature
    "grass": Material(specular=0.02, texture="grass", tile=5.0),
    "shore": Material(specular=0.02, texture="shore", tile=5.0),
    "sand": Material(specular=0.04, texture="sand", tile=2.5),
    "cobbles": Material(specular=0.03, texture="cobbles", tile=2.2),
    "path": Material(specular=0.02, texture="path", tile=1.0),
    "rock": Material(specular=0.06, texture="rock", tile=2.5),
    "bark": Material(specular=0.02, texture="bark", tile=0.8),
    "palm_bark": Material((0.92, 0.82, 0.70), 0.02, texture="bark", tile=0.6),
    "needles": Material((0.95, 1.0, 0.95), 0.02, texture="needles", tile=0.9),
    "foliage": Material((0.90, 1.00, 0.72), 0.03, texture="leaves", tile=0.8),
    "frond": Material((1.0, 1.0, 0.85), 0.05, 16, texture="frond"),
    "coconut": Material((0.40, 0.27, 0.16), 0.1, texture="bark", tile=0.3),
    "flower_red": Material((0.80, 0.17, 0.22), 0.05, texture="enamel", tile=0.05),
    "water": Material((0.10, 0.35, 0.42), 0.6, 60),
}

"""Metadata is in pyproject.toml and package.xml; this adds what colcon and the ament index need."""

from pathlib import Path
from xml.etree import ElementTree

from setuptools import setup

package = "drone_render"
manifest = ElementTree.parse(Path(__file__).resolve().with_name("package.xml"))

setup(
    version=manifest.findtext("version"),
    license=manifest.findtext("license"),
    python_requires=">=3.11,<3.14",
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "render_node = drone_render.render_node:main",
        ],
    },
)

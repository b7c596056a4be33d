"""Metadata is in pyproject.toml; this adds what colcon and the ament index need."""

from setuptools import setup

package = "drone_engine"

setup(
    license="Apache-2.0",
    python_requires=">=3.11,<3.14",
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
)

"""Version, description and license are those of package.xml, which also names the ROS packages needed."""

from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "drone_ai"
manifest = ElementTree.parse(Path(__file__).resolve().with_name("package.xml"))

setup(
    name=package,
    version=manifest.findtext("version"),
    description=manifest.findtext("description"),
    license=manifest.findtext("license"),
    maintainer=manifest.findtext("maintainer"),
    maintainer_email=manifest.find("maintainer").get("email"),
    packages=find_packages(include=[package, f"{package}.*"]),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
    install_requires=[
        "drone-engine",    # scene files
        "drone-sim",       # process, parameters and QoS of a node
    ],
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "ai_node = drone_ai.ai_node:main",
        ],
    },
)

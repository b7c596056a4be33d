"""Version, description and license are those of package.xml, which also names the ROS packages needed."""

from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup

package = "drone_sim"
manifest = ElementTree.parse(Path(__file__).resolve().with_name("package.xml"))

setup(
    name=package,
    version=manifest.findtext("version"),
    description=manifest.findtext("description"),
    license=manifest.findtext("license"),
    maintainer=manifest.findtext("maintainer"),
    maintainer_email=manifest.find("maintainer").get("email"),
    packages=find_packages(include=[package, f"{package}.*"]),
    package_data={f"{package}.node": ["fastdds.xml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
        ("bin", ["bin/topic"]),
    ],
    install_requires=[
        "drone-engine",    # the simulation
        "numpy",           # message layouts are arrays
        "PyYAML",          # metadata of bags, messages of `topic`
        "rosbags",         # bags in sqlite3, and reading bags
        "mcap",            # bags in MCAP
        "rich",            # tables of `python -m drone_sim.bag`
    ],
    zip_safe=False,  # fastdds.xml is read as a file
    entry_points={
        "console_scripts": [
            "sim_node = drone_sim.sim_node:main",
            "recorder_node = drone_sim.recorder_node:main",
        ],
    },
)

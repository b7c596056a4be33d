from setuptools import find_packages, setup

package = "drone_sim"

setup(
    name=package,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
    zip_safe=True,
    maintainer="The drone simulator developers",
    maintainer_email="drone-sim@example.org",
    description="The world: scenes, collisions, dynamics, effects, and the node around them.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "sim_node = drone_sim.sim_node:main",
            "recorder_node = drone_sim.recorder_node:main",
        ],
    },
)

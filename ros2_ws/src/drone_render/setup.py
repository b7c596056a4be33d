from setuptools import find_packages, setup

package = "drone_render"

setup(
    name=package,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={package: ["shaders/*", "fastdds.xml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{package}"]),
        (f"share/{package}", ["package.xml"]),
    ],
    zip_safe=False,
    maintainer="The drone simulator developers",
    maintainer_email="drone-sim@example.org",
    description="The picture: draws the scene off-screen and publishes camera images.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "render_node = drone_render.render_node:main",
        ],
    },
)

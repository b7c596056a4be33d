from setuptools import find_packages, setup

package = "drone_ai"

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
    description="The pilot of the second drone: flies a patrol and lands while told to.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "ai_node = drone_ai.ai_node:main",
        ],
    },
)

#!/usr/bin/env bash
# Builds message packages into an environment of ROS wheels: build.sh ENVIRONMENT PACKAGE...
# A machine with a ROS install does not need this script: there, `colcon build` builds everything.
set -euo pipefail

venv=$(cd "$1" && pwd); shift
source_dir=$(cd "$(dirname "$0")/src" && pwd)
python=$venv/bin/python
export PATH=$venv/bin:$PATH VIRTUAL_ENV=$venv AMENT_PREFIX_PATH=$venv
export PYTHONHASHSEED=0  # the generators order their output by hashes

# The wheels' CMake exports name the include folders of the machine that they were built on.
include=$("$python" -c 'import sysconfig, numpy; print(sysconfig.get_path("include") + ";" + numpy.get_include())')
sed -i "s#\"/opt/python/cp3[^\"]*\"#\"$include\"#" "$venv"/share/*/cmake/export_*__rosidl_generator_pyExport.cmake

echo "building the message packages (about a minute) ..."
mkdir -p "$venv/colcon"
if ! colcon --log-base "$venv/colcon/log" build --base-paths "$@" --build-base "$venv/colcon/build" \
    --install-base "$venv" --merge-install --symlink-install --executor sequential \
    > "$venv/colcon/output" 2>&1; then
  tail -n 40 "$venv/colcon/output" >&2
  echo "building the message packages failed; all of the output is in $venv/colcon/output" >&2
  exit 1
fi

# The Python packages run from their sources: edits take effect at once, and kernels are cached beside the sources.
for package in "$source_dir"/drone_*/setup.py; do dirname "$package"; done \
  > "$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/drone_sim_workspace.pth"

# The commands `topic` and `drone_engine`; they work without activating the environment as well.
for module in drone_sim.topic drone_engine; do
  command=$venv/bin/${module##*.}
  printf '#!/bin/sh\nexec "%s" -P -m %s "$@"\n' "$python" "$module" > "$command" && chmod +x "$command"
done

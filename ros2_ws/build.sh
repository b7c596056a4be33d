#!/usr/bin/env bash
# Builds message packages and assets into an environment of ROS wheels: build.sh ENVIRONMENT PACKAGE...
# A machine with a ROS install does not need this: there a plain `colcon build` does it all.
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

# Our Python packages run from their sources: an edit counts at once, and kernels are cached beside them.
for package in "$source_dir"/drone_*/setup.py; do dirname "$package"; done \
  > "$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/drone_sim_workspace.pth"

# The commands `topic` and `drone_engine`, which work in an environment that is not activated, too.
for command in topic drone_engine; do
  printf '#!/bin/sh\nPYTHONPATH="%s" exec "%s" -P -m %s "$@"\n' "${source_dir%/src}" "$python" "$command" \
    > "$venv/bin/$command" && chmod +x "$venv/bin/$command"
done

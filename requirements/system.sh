#!/bin/sh
# Checks for the system packages that pip cannot install: system.sh PYTHON. Installs them if run as root with apt, or else
# prints the command that does.
set -u
python=$1
missing=

command -v "$python" > /dev/null 2>&1 || missing="$missing python3"
command -v gcc > /dev/null 2>&1 || missing="$missing gcc"
command -v g++ > /dev/null 2>&1 || missing="$missing g++"
if command -v "$python" > /dev/null 2>&1; then
  "$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 14))' || {
    echo "make: $("$python" --version) found, but ROS 2 Jazzy needs Python 3.11, 3.12 or 3.13; name one with: make fly PYTHON=python3.12" >&2
    exit 1
  }
  version=$("$python" -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
  "$python" -c 'import ensurepip, venv' 2> /dev/null || missing="$missing $version-venv"
  "$python" -c 'import os, sys, sysconfig; sys.exit(not os.path.exists(sysconfig.get_path("include") + "/Python.h"))' \
    || missing="$missing $version-dev"
fi
has_library() { "$python" -c "import ctypes; ctypes.CDLL('$1')" 2> /dev/null; }
if command -v "$python" > /dev/null 2>&1; then
  has_library libEGL.so.1 || missing="$missing libegl1"
  has_library libGL.so.1 || missing="$missing libgl1"
fi
# A GL driver: Mesa's software rasterizer, unless a vendor's driver is installed.
[ -n "$(ls /usr/share/glvnd/egl_vendor.d /etc/glvnd/egl_vendor.d 2> /dev/null | grep json)" ] \
  || missing="$missing libegl-mesa0 libgl1-mesa-dri"

[ -z "$missing" ] && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null 2>&1; then
  echo "installing$missing ..."
  log=$(mktemp)
  { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends $missing; } \
    > "$log" 2>&1 && exit 0
  tail -n 5 "$log" >&2
fi
echo "make: missing on this system; type: sudo apt-get install$missing" >&2
exit 1

#!/usr/bin/env bash
# What it costs to call goingrate from Python: overhead of a call, copies of large arrays, ten million phases
# beside the command. python.sh [PHASES]. Takes a minute, and wants a quiet machine.
set -euo pipefail
. "$(dirname "$0")/common.sh"
goingrate_setup python3-numpy python3-dev pybind11-dev
cmake --preset release -DGOINGRATE_PYTHON=ON > /dev/null
cmake --build --preset release -j2 --target goingrate_command goingrate_python > /dev/null
head_line
PYTHONPATH=build/release/python exec /usr/bin/python3 tests/studies/python.py build/release/goingrate "$@"

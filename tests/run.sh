#!/usr/bin/env bash
# Sets up, builds and runs all tests; ends with ctest's summary. Arguments go to ctest.
# With --sanitize first: the suite under AddressSanitizer and UndefinedBehaviorSanitizer, then the tests that
# start threads, and the fits, under ThreadSanitizer. Takes about two hours on two cores. Tests that build a
# package of their own, or use outside programs (notebooks, Slurm), are left out.
# With --fuzz [SECONDS]: fuzzes the reader, scenario files and recordings of sound, for a minute if not given; another
# ten minutes go into building the parts needed by clang with sanitizers.
# With --cluster: batches in shares on a Slurm of one node, under GNU parallel and under Snakemake, with one share
# killed at work, compared with one process. Takes two minutes.
# With --notebooks first: only executes the notebooks of data/course/notebooks, and puts their pages into
# build/release/notebooks.
# With --web: builds the page that runs in a browser, compares its numbers with the command's on logs of all
# formats, and uses it in headless Chromium. Takes half an hour on two cores.
set -euo pipefail
cd "$(dirname "$0")/.."
. apps/setup.sh
goingrate_setup libgtest-dev dpkg-dev file pybind11-dev python3-dev python3-numpy python3-pytest
command -v gnuplot > /dev/null || goingrate_setup gnuplot-nox # for figures as PDF and PNG
if [ "${1:-}" = --sanitize ]; then
  shift
  for preset in dev threads; do
    cmake --preset "$preset" -DBUILD_TESTING=ON -DGOINGRATE_PYTHON=ON > /dev/null
  done
  cmake --build --preset dev -j2
  ctest --preset dev "$@"
  # Without address space randomisation: the sanitizer's memory has its fixed place. The build runs
  # the programs to list their tests.
  setarch -R cmake --build --preset threads -j2 --target test_base test_dynamics test_spectra test_fit test_drive
  exec setarch -R ctest --preset threads "$@"
fi
if [ "${1:-}" = --fuzz ]; then
  goingrate_setup libgtest-dev clang libclang-rt-dev
  exec tests/fuzz/run.sh "${2:-60}" build/fuzz
fi
if [ "${1:-}" = --cluster ]; then
  goingrate_setup libgtest-dev slurm-wlm parallel snakemake
  cmake --preset release > /dev/null
  cmake --build --preset release -j2 --target goingrate_command
  GOINGRATE_CLUSTER=all exec tests/cluster/run.sh build/release/goingrate . build/release/cluster
fi
if [ "${1:-}" = --web ]; then
  goingrate_setup libgtest-dev emscripten dpkg-dev chromium zip unzip
  cmake --preset release > /dev/null
  cmake --build --preset release -j2 --target goingrate_command
  exec tests/web/run.sh build/release/goingrate . build/web
fi
# Without them the test of a batch's shares leaves Slurm and GNU parallel out.
[ -z "${CI:-}" ] || goingrate_setup slurm-wlm parallel
# For the notebooks, and for what of Python is skipped without.
goingrate_setup python3-pandas python3-matplotlib python3-pip mypy jupyter-nbconvert python3-ipykernel \
  python3-lmfit python3-iminuit python3-distributed
if [ "${1:-}" = --notebooks ]; then
  cmake --preset release -DBUILD_TESTING=ON -DGOINGRATE_PYTHON=ON > /dev/null
  cmake --build --preset release -j2 --target goingrate_command goingrate_python
  exec tests/python/notebooks.sh /usr/bin/python3 . build/release
fi
command -v doxygen > /dev/null || goingrate_setup doxygen # for the library's documentation
if [ -n "${CI:-}" ] && [ ! -e build ]; then
  # As a newcomer does on a fresh clone; what the demo builds is not built again.
  ./apps/demo.sh
  tail -c 8 build/interruption.html | grep -q '</html>'
fi
# A newer compiler may warn of more; only the project's own checks insist.
cmake --preset release -DBUILD_TESTING=ON -DGOINGRATE_PYTHON=ON ${CI:+-DGOINGRATE_WARNINGS_AS_ERRORS=ON} > /dev/null
cmake --build --preset release -j2
[ -d ../shared/real ] \
  || echo "There is no ../shared/real with public measurements: the tests that need them are skipped."
ctest --preset release "$@"

# Sourced by the study scripts. Changes to the project's root directory, installs the packages that
# the studies need, and defines functions: `built TARGET...` builds study programs with the
# bench preset; `head_line [SEED]` prints where a result comes from: date, CPU, commit and any seed.
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev

built() {
  cmake --preset bench > /dev/null
  cmake --build --preset bench -j2 --target "$@" > /dev/null
}

# Builds the command as `$goingrate`, and makes a folder `$here` that goes with the script.
built_command() {
  cmake --preset release > /dev/null
  cmake --build --preset release -j2 --target goingrate_command > /dev/null
  goingrate=$PWD/build/release/goingrate
  here=$(mktemp -d)
  trap 'rm -rf "$here"' EXIT
}

head_line() {
  date -u +%Y-%m-%d
  grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
  echo "commit $(git rev-parse --short HEAD)${1:+, seed $1}"
}

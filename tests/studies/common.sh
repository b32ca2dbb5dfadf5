# Sourced by the studies. Goes to the project's folder; `built NAME...` builds studies with the bench
# preset; `head_line SEED` prints what a print is kept with: date, machine, commit, seed.
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
. apps/setup.sh
goingrate_setup libgtest-dev zlib1g-dev libbenchmark-dev libsundials-dev libgsl-dev

built() {
  cmake --preset bench > /dev/null
  cmake --build --preset bench -j2 --target "$@" > /dev/null
}

head_line() {
  date -u +%Y-%m-%d
  grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'
  echo "commit $(git rev-parse --short HEAD)${1:+, seed $1}"
}

#!/usr/bin/env bash
# The Python package as people get it: `pip install ./apps/python`, without a network, and the .deb.
# python.sh PYTHON SOURCE BUILD CPACK
set -euo pipefail
python=$1 source=$(realpath "$2") build=$(realpath "$3") cpack=$4
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export PYTHONDONTWRITEBYTECODE=1

works() { # FOLDER: what is installed there, and not what was built
  (cd "$scratch" && PYTHONPATH=$1 "$python" - "$1" "$source/data/logs/jump.csv" << 'END')
import sys
import goingrate as gr
assert gr.__file__.startswith(sys.argv[1]), gr.__file__
fit = gr.fit(gr.read(sys.argv[2]), fix={"T0": 2}, events=["150:mu"])
print(gr.__version__, fit["epsilon"])
END
}

if "$python" -m pip --version > /dev/null 2>&1; then
  "$python" -m pip install --quiet --disable-pip-version-check --root-user-action=ignore --no-index \
    --no-deps --config-settings "build-dir=$build" --target "$scratch/pip" "$source/apps/python"
  works "$scratch/pip"
  ls "$scratch/pip/goingrate/py.typed" "$scratch"/pip/goingrate-*.dist-info/RECORD > /dev/null
else
  echo "no pip here: the wheel is not tried"
fi

command -v dpkg-shlibdeps > /dev/null || { echo "no dpkg-shlibdeps here: skipped"; exit 77; }
(cd "$build" && "$cpack" -G DEB -B "$scratch/debs") > "$scratch/cpack.log" || { cat "$scratch/cpack.log"; exit 1; }
deb=$(ls "$scratch"/debs/python3-goingrate_*.deb)
depends=$(dpkg-deb -f "$deb" Depends)
echo "Depends: $depends"
for package in 'python3 (>= ' 'python3 (<< ' python3-numpy libc6 libfftw3; do
  grep -qF "$package" <<< "$depends"
done
dpkg-deb -x "$deb" "$scratch/deb"
works "$scratch/deb/usr/lib/python3/dist-packages"
# Each file is in one of the packages only.
dpkg-deb -c "$scratch"/debs/goingrate_*.deb > "$scratch/list"
if grep -q dist-packages "$scratch/list"; then
  echo "the package of the command has Python's files too"
  exit 1
fi

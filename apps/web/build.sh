#!/usr/bin/env bash
# build.sh [FLAGS]: makes build/web/goingrate.html, the page that runs goingrate in a browser. Installs what is
# missing (Debian), compiles the libraries (once) and goingrate to WebAssembly, and puts everything into one file.
# FLAGS are for the compiler, "-O2" if not given; code compiled with other flags is compiled again.
set -euo pipefail
cd "$(dirname "$0")/../.."
. apps/setup.sh
goingrate_setup emscripten dpkg-dev
flags=${1:--O2}
folder=$PWD/build/web
mkdir -p "$folder"
. apps/web/environment.sh
echo "Compiling libraries to WebAssembly (once, a few minutes)" >&2
apps/web/libraries.sh "$folder/libraries"
echo "Compiling goingrate to WebAssembly" >&2
cmake -G Ninja -S . -B "$folder/wasm" -DCMAKE_TOOLCHAIN_FILE="$PWD/apps/web/toolchain.cmake" \
  -DGOINGRATE_WEB_PREFIX="$folder/libraries/prefix" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_FLAGS_RELEASE="$flags -DNDEBUG" > /dev/null
cmake --build "$folder/wasm" -j "$(nproc)"
node apps/web/assemble.mjs "$PWD" "$folder"

#!/usr/bin/env bash
# portable.sh SOURCE FOLDER: every source of the page passes Emscripten's compiler as far as code generation: its
# grammar, its types, and the parts of the standard library that exist there. Takes two minutes.
set -euo pipefail
source=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
. "$source/apps/web/environment.sh"
"$source/apps/web/libraries.sh" "$folder/libraries" headers
cmake -G Ninja -S "$source" -B "$folder/wasm" -DCMAKE_TOOLCHAIN_FILE="$source/apps/web/toolchain.cmake" \
  -DGOINGRATE_WEB_PREFIX="$folder/libraries/prefix" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DGOINGRATE_PLOTLY=OFF > /dev/null
cd "$folder/wasm"
ninja -t targets all | sed -n 's/^\(.*cmake_pch.hxx.pch\): .*/\1/p' | xargs ninja > "$folder/headers.log" \
  || { tail -n 20 "$folder/headers.log"; exit 1; }
# Each command as CMake wrote it, less where its object would go.
node -e 'for (const { command, file } of JSON.parse(require("fs").readFileSync("compile_commands.json", "utf8")))
  if (!file.includes("cmake_pch")) console.log(command.replace(/ -o \S+/, "") + " -fsyntax-only -Wno-everything");' > "$folder/commands"
xargs -P "$(nproc)" -d '\n' -n 1 bash -c < "$folder/commands" > "$folder/faults.log" 2>&1 \
  || { grep -m 20 -A 5 error "$folder/faults.log"; exit 1; }
echo "ok    $(wc -l < "$folder/commands") sources pass Emscripten's compiler"

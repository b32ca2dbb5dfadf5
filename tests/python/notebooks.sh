#!/usr/bin/env bash
# Executes every notebook of the course and the comparisons, from its first cell to its last, and leaves its
# page in BUILD/notebooks. Their own assertions say what must come out. They are kept without outputs.
# notebooks.sh PYTHON SOURCE BUILD
set -euo pipefail
python=$1 source=$(realpath "$2") build=$(realpath "$3")
"$python" -c 'import nbconvert, ipykernel' 2> /dev/null || { echo "no nbconvert and ipykernel here: skipped"; exit 77; }
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
export PYTHONPATH=$build/python JUPYTER_DATA_DIR=$here/jupyter JUPYTER_RUNTIME_DIR=$here/runtime \
  JUPYTER_CONFIG_DIR=$here/config IPYTHONDIR=$here/ipython MPLCONFIGDIR=$here/matplotlib PYTHONDONTWRITEBYTECODE=1
"$python" -m ipykernel install --prefix "$here/kernels" --name goingrate > /dev/null 2>&1
export JUPYTER_PATH=$here/kernels/share/jupyter
mkdir -p "$build/notebooks"
faults=0
for notebook in "$source"/data/course/notebooks/*.ipynb; do
  name=$(basename "$notebook" .ipynb)
  if ! "$python" - "$notebook" << 'END'
import json, sys
cells = json.load(open(sys.argv[1], encoding="utf-8"))["cells"]
sys.exit(any(cell.get("outputs") or cell.get("execution_count") for cell in cells))
END
  then
    echo "$name: has outputs; clear them before it is kept"
    faults=$((faults + 1))
  fi
  begin=$SECONDS
  if (cd "$source/data/course/notebooks" && "$python" -m nbconvert --to html --execute \
    --ExecutePreprocessor.kernel_name=goingrate --ExecutePreprocessor.timeout=600 \
    --output-dir "$build/notebooks" "$notebook") > "$here/log" 2>&1; then
    echo "$name: $((SECONDS - begin)) s"
  else
    echo "$name: failed"
    tail -n 25 "$here/log"
    faults=$((faults + 1))
  fi
done
[ "$faults" -eq 0 ]

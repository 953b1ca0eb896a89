#!/usr/bin/env bash
# clang-tidy over the library, the command and the Python module, and the syntax of the programs of validation/.
#   tools/lint.sh [--fresh] [FILE...]      FILEs: formatting and clang-tidy of these sources alone; --fresh: read every group again
# clang-tidy leaves out the tests (the compiler's warnings hold them, and they would double its time) and the lane
# kernels (three times the same text, whose templates take it minutes).
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=$(nproc)
fresh=()
if [[ ${1:-} == --fresh ]]; then fresh=(--fresh); shift; fi

cmake --preset tidy -DPython3_EXECUTABLE="${PYTHON:-/usr/bin/python3}" >/dev/null
cmake --build --preset tidy --target mottle_build_identity >/dev/null
if (($# > 0)); then
  tools/check_style.sh "$@"
else
  echo "programs of validation/, which no other step compiles"
  find validation -name '*.cpp' -print0 |
    xargs -0 -r -P "$jobs" -n 1 "${CXX:-c++}" -std=c++20 -fsyntax-only -Iinclude -Isrc -Itests -isystem /usr/include/eigen3
fi
python3 tools/tidy.py build/tidy "$jobs" "${fresh[@]}" "$@"
echo "lint: nothing found"

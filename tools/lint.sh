#!/usr/bin/env bash
# clang-format over everything, the checks of layers and type names, the syntax of validation/, clang-tidy over the library, the
# command and, where it is configured, the Python module.
#   tools/lint.sh BUILD_DIR JOBS [FILE...]      BUILD_DIR must be configured; clang-tidy reads FILEs alone
# clang-tidy leaves out the tests (the compiler's warnings hold them, and they would double its time) and the lane
# kernels (written in GCC's vector extensions, which clang does not take).
set -euo pipefail
cd "$(dirname "$0")/.."
build=$1 jobs=$2
shift 2

echo "clang-format"
find include src apps bindings tests benchmarks web -name node_modules -prune -o \( -name '*.cpp' -o -name '*.hpp' \) -print0 |
  xargs -0 -r -P "$jobs" -n 16 clang-format --dry-run -Werror
python3 tools/check_layers.py
python3 tools/check_type_names.py

echo "sources that are cited"
keys=$(grep -rhoE '\[[A-Z][A-Za-z]+(19|20)[0-9]{2}[a-z]?\]' include src apps docs benchmarks --include='*.[ch]pp' --include='*.md' | tr -d '[]' | sort -u)
for key in $keys; do
  grep -q "^@[a-z]*{$key," docs/references.bib || { echo "docs/references.bib has no entry $key" >&2; exit 1; }
done

echo "programs of validation/, which no other step compiles"
find validation -name '*.cpp' -print0 |
  xargs -0 -r -P "$jobs" -n 1 "${CXX:-c++}" -std=c++20 -fsyntax-only -Iinclude -Isrc -Itests -isystem /usr/include/eigen3

python3 tools/tidy.py "$build" "$jobs" "$@"
echo "lint: nothing found"

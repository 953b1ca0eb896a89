#!/usr/bin/env bash
# What needs no build: formatting, layers, type names, cited sources, and the checks' own tests.
#   tools/check_style.sh [FILE...]      FILEs: formatting of these sources alone
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=$(nproc)

echo "clang-format"
if (($# > 0)); then
  printf '%s\0' "$@"
else
  find include src apps bindings modules tests benchmarks validation web -name node_modules -prune -o \( -name '*.cpp' -o -name '*.hpp' \) -print0
fi | xargs -0 -r -P "$jobs" -n 16 clang-format --dry-run -Werror

echo "layers, type names"
python3 tools/check_layers.py
python3 tools/check_type_names.py

echo "sources that are cited"
keys=$(grep -rhoE '\[[A-Z][A-Za-z]+(19|20)[0-9]{2}[a-z]?\]' include src apps docs benchmarks --include='*.[ch]pp' --include='*.md' | tr -d '[]' | sort -u)
for key in $keys; do
  grep -q "^@[a-z]*{$key," docs/references.bib || { echo "docs/references.bib has no entry $key" >&2; exit 1; }
done
echo "style: nothing found"

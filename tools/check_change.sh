#!/usr/bin/env bash
# What a change is likely to break, for the desk: style, the tests of the layers that the change touches and of the layers above
# them, and four scripts of the command. clang-tidy is left out (tools/lint.sh).
#   tools/check_change.sh [BASE]      BASE: what the change is counted from (default: where this branch left origin's main, else
#                                     HEAD); uncommitted changes count
set -euo pipefail
cd "$(dirname "$0")/.."
base=${1:-$(git merge-base HEAD origin/main 2>/dev/null || echo HEAD)}
mapfile -t changed < <({ git diff --name-only --diff-filter=d "$base"; git ls-files --others --exclude-standard; } | sort -u)
echo "${#changed[@]} files changed since $(git rev-parse --short "$base")"

mapfile -t sources < <(printf '%s\n' "${changed[@]}" | grep -E '\.[ch]pp$' | grep -vE '^web/' || true)
if ((${#sources[@]} > 0)); then tools/check_style.sh "${sources[@]}"; else tools/check_style.sh /dev/null; fi

# A test's change concerns its own layer, any other all layers above it.
layers=$(python3 - "${changed[@]}" <<'EOF_PYTHON'
import pathlib, sys
sys.path.insert(0, "tools")
import check_layers
reach = check_layers.close_over(check_layers.read_table(pathlib.Path("tools/layers.txt")))
touched = {(check_layers.layer_of(pathlib.PurePath(file).parts), file.startswith("tests/")) for file in sys.argv[1:]}
print(*(layer for layer in reach if any(name == layer or not of_tests and name in reach[layer] for name, of_tests in touched)))
EOF_PYTHON
)
if [[ -z $layers ]]; then
  echo "no layer is touched: nothing to build"
  exit 0
fi
echo "layers touched, and those above that include what changed: $layers"
cmake --preset release -DMOTTLE_BUILD_TESTS=ON >/dev/null
targets=(mottle_app)
for layer in $layers; do [[ $layer == apps ]] || targets+=("mottle_${layer}_tests"); done
cmake --build --preset release --target "${targets[@]}"
ctest --preset release --label-regex "^(${layers// /|})$" --label-exclude "apps|timed|nightly|browser"
ctest --preset release --tests-regex "^apps_(results|errors|init|export)$"

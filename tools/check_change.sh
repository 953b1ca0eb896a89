#!/usr/bin/env bash
# What a change is likely to break, for the desk: style, the tests of the layers that the change touches and of the layers above
# them, the scripts that it changes and four others of the command. clang-tidy is left out (tools/lint.sh); what else it leaves
# out is said at the end.
#   tools/check_change.sh [BASE]      BASE: what the change is counted from (default: where this branch left origin's main, else
#                                     HEAD); uncommitted changes count
set -euo pipefail
cd "$(dirname "$0")/.."
base=$(git rev-parse --verify "${1:-$(git merge-base HEAD origin/main 2>/dev/null || echo HEAD)}^{commit}")
mapfile -t changed < <({ git diff --name-only "$base"; git ls-files --others --exclude-standard; } | sort -u)
echo "${#changed[@]} files changed since $(git rev-parse --short "$base")"

sources=()
for file in "${changed[@]}"; do
  if [[ -f $file && $file =~ \.[ch]pp$ && $file != web/* ]]; then sources+=("$file"); fi
done
tools/check_style.sh "${sources[@]:-/dev/null}"

# The layers to test, then scripts, then the steps that a changed file asks for beside them.
mapfile -t found < <(python3 - "${changed[@]}" <<'EOF_PYTHON'
import pathlib, re, sys
sys.path.insert(0, "tools")
import check_layers
reach = check_layers.close_over(check_layers.read_table(pathlib.Path("tools/layers.txt")))
layers, scripts, others = set(), set(), set()
for name in sys.argv[1:]:
    path = pathlib.PurePath(name)
    folder, layer = path.parts[0], check_layers.layer_of(path.parts)
    if re.match(r"tests/(apps|attack)/.*_test.py", name):
        scripts.add(f"{path.parts[1]}_{'nightly_' if 'nightly' in path.parts else ''}{path.stem.removesuffix('_test')}")
    elif name.endswith("_test.cpp") and layer in reach:
        layers.add(layer)  # a test concerns its own layer, whatever else lies there all layers above it
    elif layer in reach:
        layers.update(above for above in reach if layer in reach[above])
    elif folder in ("include", "cmake") or re.match(r"CMake.*|tests/(support/.*|CMakeLists.txt)|modules/openturns/.*", name):
        layers.update(reach)
    elif folder == "modules":
        scripts.add("apps_ranks")
    elif folder == "bindings" or name.startswith("tests/python/"):
        others.add("make python")
    elif folder in ("web", "benchmarks", "validation", "examples", "tests", "tools", ".ci", "Makefile"):
        others.add("make bench" if folder == "benchmarks" else "make test")
print(*(layer for layer in reach if layer in layers))
print(*sorted(scripts))
print(*sorted(others), sep=", ")
EOF_PYTHON
)
layers=${found[0]} scripts=${found[1]} others=${found[2]}
if [[ -z $layers$scripts ]]; then
  echo "no layer is touched: nothing to build${others:+; not done here: $others}"
  exit 0
fi
echo "layers touched, and those above that include what changed: ${layers:-none}; scripts: ${scripts:-none}"
cmake --preset release -DMOTTLE_BUILD_TESTS=ON >/dev/null
targets=(mottle_app)
for layer in $layers; do targets+=("mottle_${layer}_tests"); done
if [[ $scripts == *apps_ranks* ]]; then targets+=(mottle_mpi); fi
cmake --build --preset release --target "${targets[@]}"
if [[ -n $layers ]]; then
  ctest --preset release --label-regex "^(${layers// /|})$" --label-exclude "timed|nightly|browser" --exclude-regex "^apps_.*[^0-9]$"
fi
scripts+=" apps_results apps_errors apps_init apps_export"
ctest --preset release --tests-regex "^(${scripts// /|})$"
echo "not done here: clang-tidy (tools/lint.sh)${others:+, $others}"

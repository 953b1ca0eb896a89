#!/usr/bin/env bash
# Lets every fuzzer look for faults for a while, all at once. Stops with what was found; inputs that reach new code are
# kept in BUILD/corpus and used by the next run.
#   tools/fuzz.sh BUILD SECONDS
set -euo pipefail
build=$1 seconds=$2
cd "$(dirname "$0")/.."

# Every word in capitals that the reader knows is a token worth trying.
grep -oh '"[A-Z][A-Z0-9]*"' src/formats/nastran/*.cpp | sort -u >"$build/nastran.dict"
grep -oh '"[a-z][a-z_-]*"' src/study/input/read_*.cpp | sort -u >"$build/study.dict"
mkdir -p "$build/studies"
for study in examples/*/*.toml; do cp "$study" "$build/studies/$(basename "$(dirname "$study")")-$(basename "$study")"; done

fuzz() {
  local name=$1
  shift
  mkdir -p "$build/corpus/$name"
  # By the clock: a long search runs beside other work, which may keep one of ten from its turn for a minute.
  "$build/tests/fuzz/${name}_fuzz" -max_total_time="$seconds" -max_len=4096 -timeout="$((seconds > 600 ? seconds / 6 : 60))" -rss_limit_mb=2048 \
    -print_final_stats=1 -artifact_prefix="$build/$name-" "$build/corpus/$name" "$@" >"$build/$name.log" 2>&1
}

declare -A job
start() {
  fuzz "$@" &
  job[$1]=$!
}
start nastran -dict="$build/nastran.dict" tests/formats/nastran
start csv examples/01-three-masses
start uff tests/formats/uff examples/05-uff-population/specimens
start matrix tests/formats/matrices
start solver_output -dict=tests/fuzz/solver_output.dict tests/fuzz/solver_output
start mat tests/formats/mat tests/fuzz/hdf5
start hdf5 -detect_leaks=0 tests/fuzz/hdf5 tests/formats/matrices  # the HDF5 library leaks on files that it refuses
start calculix tests/fuzz/calculix examples/03-plate-calculix
start gmsh tests/formats/gmsh
start umbridge tests/fuzz/umbridge
start report tests/fuzz/report
start study -dict="$build/study.dict" "$build/studies"

failed=0
for name in "${!job[@]}"; do
  if wait "${job[$name]}"; then
    echo "$name: $(grep -oP 'number_of_executed_units: *\K\d+' "$build/$name.log") executions, no finding"
  else
    failed=1
    echo "::: $build/$name.log"
    tail -40 "$build/$name.log"
  fi
done
exit $failed

#!/usr/bin/env bash
# Lets every fuzzer look for faults for a while, all at once. Stops with what was found; inputs that reach new code are
# kept in BUILD/corpus and used by the next run, the fewest that reach as much in BUILD/kept/NAME.hex, to be copied to
# tests/fuzz/corpus: an input a line, in hexadecimal.
#   tools/fuzz.sh BUILD SECONDS
set -euo pipefail
build=$1 seconds=$2
cd "$(dirname "$0")/.."

# Every word in capitals that the reader knows is a token worth trying.
grep -oh '"[A-Z][A-Z0-9]*"' src/formats/nastran/*.cpp | sort -u >"$build/nastran.dict"
grep -oh '"[a-z][a-z_-]*"' src/study/input/read_*.cpp | sort -u >"$build/study.dict"
# A search starts from the seeds and from what searches have kept.
fuzz() {
  local name=$1
  shift
  mkdir -p "$build/corpus/$name" "$build/seeds/$name"
  for seed in $(sed -n "s/^$name: //p" tests/fuzz/seeds.txt); do cp "$seed" "$build/seeds/$name/$(tr / - <<<"$seed")"; done
  if [[ -f tests/fuzz/corpus/$name.hex ]]; then
    local number=0 line
    while read -r line; do printf "$(sed 's/../\\x&/g' <<<"$line")" >"$build/seeds/$name/kept-$((++number))"; done <"tests/fuzz/corpus/$name.hex"
  fi
  # By the clock: a long search runs beside other work, which may keep one of ten from its turn for a minute.
  "$build/tests/fuzz/${name}_fuzz" -max_total_time="$seconds" -max_len=4096 -timeout="$((seconds > 600 ? seconds / 6 : 60))" -rss_limit_mb=2048 \
    -print_final_stats=1 -artifact_prefix="$build/$name-" "$@" "$build/corpus/$name" "$build/seeds/$name" >"$build/$name.log" 2>&1
}

# The fewest inputs, none above 1 kB, that reach what the search has reached beyond the seeds.
keep() {
  local name=$1 least=$build/least/$1
  rm -rf "$least"
  mkdir -p "$build/kept"
  cp -r "$build/seeds/$name" "$least"
  "$build/tests/fuzz/${name}_fuzz" -merge=1 -detect_leaks=0 "$least" "$build/corpus/$name" >>"$build/$name.log" 2>&1
  find "$least" -size -1025c -type f -printf '%f\n' | while read -r input; do
    if [[ ! -f $build/seeds/$name/$input || $input == kept-* ]]; then od -An -v -tx1 "$least/$input" | tr -d ' \n'; echo; fi
  done | sort >"$build/kept/$name.hex"
}

declare -A job
start() {
  fuzz "$@" &
  job[$1]=$!
}
for name in csv uff matrix mat gmsh umbridge report calculix; do start "$name"; done
start nastran -dict="$build/nastran.dict"
start solver_output -dict=tests/fuzz/solver_output.dict
start study -dict="$build/study.dict"
start hdf5 -detect_leaks=0  # the HDF5 library leaks on files that it refuses

failed=0
for name in "${!job[@]}"; do
  if wait "${job[$name]}"; then
    echo "$name: $(grep -oP 'number_of_executed_units: *\K\d+' "$build/$name.log") executions, no finding"
    keep "$name"
  else
    failed=1
    echo "::: $build/$name.log"
    tail -40 "$build/$name.log"
  fi
done
exit $failed

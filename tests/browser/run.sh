#!/usr/bin/env bash
# Checks reports in a browser: run.sh written|simulated|thorough MOTTLE SOURCE_FOLDER WORK_FOLDER
#   written    the pages that the command writes of the first example: an update, a propagation, a population, a posterior, batches, a box,
#              accepted simulations, a comparison, a diagnosis
#   simulated  made-up data in a page that the command has written: every scale, many parameters, hardly any numbers, structures
#   thorough   both, every check on every page, with pictures of all that is shown in WORK_FOLDER/thorough/screenshots
set -euo pipefail
part=$1 mottle=$2 source=$3 work=$4
if ! command -v chromium >/dev/null; then
  echo "skipped: there is no chromium here (tools/install_packages.sh --test)"
  exit 77
fi
here=$work/$part
rm -rf "$here"
mkdir -p "$here"
cp -r "$source"/web/{package.json,src,test} "$here/"

# One copy of the browser's driver serves all parts, which find it in the folder above.
exec {lock}>"$work/lock"
flock "$lock"
if [[ ! $work/node_modules/installed -nt $source/web/package-lock.json ]]; then
  cp "$source"/web/{package.json,package-lock.json,.npmrc} "$work/"
  (cd "$work" && npm ci --omit=optional --ignore-scripts --prefer-offline --no-progress --loglevel=error)
  touch "$work/node_modules/installed"
fi
exec {lock}>&-

example=$source/examples/01-three-masses
pages=() results=()
run() {  # FOLDER COMMAND STUDY OPTIONS...: a page of the report
  "$mottle" "${@:2}" --out "$here/$1" --quiet
}

if [[ $part != simulated ]]; then
  run update update "$example/case2.toml"
  run propagate propagate "$example/case2.toml"
  run population update "$example/case1.toml" --set 'update.method="maximum-likelihood"'
  run posterior update "$example/case1.toml" --set 'update.method="bayes"'
  for method in mixture interval abc; do run "$method" update "$example/case1.toml" --set "update.method=\"$method\""; done
  mkdir -p "$here/diagnosed"
  sed 's/stiffness = 3.0/stiffness = 2.0/' "$example/shapes.toml" >"$here/diagnosed/wrong.toml"  # a spring of the tests is stiffer
  cp "$example/specimens-shapes.csv" "$here/diagnosed/"
  run diagnosed diagnose "$here/diagnosed/wrong.toml"
  # Five runs to compare, one of them without a parameter of the others, two with an evidence.
  study=$here/compared/study.toml
  mkdir -p "$here/compared"
  find "$example" -maxdepth 1 -type f -exec cp -t "$here/compared" {} +  # no results of a demo
  cp "$here/compared/case1.toml" "$study"
  run compared/a update "$study"
  run compared/b update "$study" --set 'update.method="maximum-likelihood"'
  bayes=(--set 'update.method="bayes"' --set 'test.repeatability={"f*"=0.02}')
  run compared/d update "$study" "${bayes[@]}"
  run compared/e update "$study" "${bayes[@]}" --seed 2
  python3 - "$study" <<'PYTHON'
import pathlib, sys
study = pathlib.Path(sys.argv[1])
head, *blocks = study.read_text().split("[[parameter]]")
study.write_text(head + "".join("[[parameter]]" + block for block in blocks if '"k1"' not in block.split("distribution")[0]))
PYTHON
  run compared/c update "$study" --set 'update.method="deterministic"'
  "$mottle" compare "$here"/compared/{a,b,c,d,e} --out "$here/compared/compare.html" >"$here/compared/table.txt"
  pages+=("$here"/{update,propagate,population,posterior,mixture,interval,abc}/report.html "$here/compared/compare.html" "$here/diagnosed/diagnosis.html")
  for folder in "$here"/compared/{a,b,c,d,e}; do results+=(--results "$folder"); done
fi

if [[ $part != written ]]; then
  simulated=(modes diagnosis linear-diagnosis shapes population posterior batches old aeroplane sparse)
  template=$here/propagate/report.html
  [[ -e $template ]] || run propagate propagate "$example/case2.toml"
  cd "$here"
  node test/make_fixture.mjs "$here/simulated" "$template" "${simulated[@]}"
  for page in "${simulated[@]}"; do pages+=("$here/simulated/$page.html"); done
fi

options=(--screenshots "$here/screenshots")
if [[ $part == simulated ]]; then
  for page in population posterior batches old sparse; do options+=(--laid-out-as-others "$page"); done  # as those written, and aeroplane
fi
[[ $part != thorough ]] || options+=(--thorough)
cd "$here"
exec node test/report_test.mjs "${pages[@]}" "${results[@]}" "${options[@]}"

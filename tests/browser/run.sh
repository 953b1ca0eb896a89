#!/usr/bin/env bash
# Runs a job of the first example and checks its report in a browser: run.sh JOB MOTTLE SOURCE_FOLDER WORK_FOLDER
set -euo pipefail
job=$1 mottle=$2 source=$3 work=$4
if ! command -v chromium >/dev/null; then
  echo "skipped: there is no chromium here (tools/install_packages.sh --test)"
  exit 77
fi
mkdir -p "$work/web"
cp -r "$source"/web/{package.json,package-lock.json,.npmrc,src,test} "$work/web/"
if [[ ! $work/web/node_modules/installed -nt $work/web/package-lock.json ]]; then
  (cd "$work/web" && npm ci --omit=optional --ignore-scripts --prefer-offline --no-progress --loglevel=error)
fi
touch "$work/web/node_modules/installed"
if [[ $job == compare ]]; then  # five runs, one of them without a parameter of the others, two with an evidence
  study=$work/compare/study.toml
  mkdir -p "$work/compare"
  find "$source/examples/01-three-masses" -maxdepth 1 -type f -exec cp -t "$work/compare" {} +  # no results of a demo
  cp "$work/compare/case1.toml" "$study"
  "$mottle" update "$study" --out "$work/compare/a" --quiet
  "$mottle" update "$study" --out "$work/compare/b" --quiet --set 'update.method="maximum-likelihood"'
  bayes=(--quiet --set 'update.method="bayes"' --set 'test.repeatability={"f*"=0.02}')
  "$mottle" update "$study" --out "$work/compare/d" "${bayes[@]}"
  "$mottle" update "$study" --out "$work/compare/e" "${bayes[@]}" --seed 2
  python3 - "$study" <<'EOF'
import pathlib, sys
study = pathlib.Path(sys.argv[1])
head, *blocks = study.read_text().split("[[parameter]]")
study.write_text(head + "".join("[[parameter]]" + block for block in blocks if '"k1"' not in block.split("distribution")[0]))
EOF
  "$mottle" update "$study" --out "$work/compare/c" --quiet --set 'update.method="deterministic"'
  "$mottle" compare "$work"/compare/{a,b,c,d,e} --out "$work/compare/page.html" >"$work/compare/table.txt"
  cd "$work/web"
  exec node test/compare_test.mjs "$work/compare/page.html" "$work"/compare/{a,b,c,d,e} --screenshots "$work/screenshots-compare"
fi
run=("$job" "$source/examples/01-three-masses/case2.toml")
[[ $job != posterior ]] || run=(update "$source/examples/01-three-masses/case1.toml" --set 'update.method="bayes"')
[[ $job != population ]] || run=(update "$source/examples/01-three-masses/case1.toml" --set 'update.method="maximum-likelihood"')
"$mottle" "${run[@]}" --out "$work/$job" --quiet
cd "$work/web"
node test/report_test.mjs "$work/$job/report.html" --screenshots "$work/screenshots-$job"
[[ $job == update || $job == population ]] || exit 0
# Made-up data in the page that the program has just written: a structure; or every scale, many parameters, hardly any numbers.
pages=(modes shapes)
if [[ $job == population ]]; then
  pages=(population posterior old aeroplane sparse)
fi
node test/make_fixture.mjs "$work/fixtures-$job" "$work/$job/report.html"
for page in "${pages[@]}"; do
  node test/report_test.mjs "$work/fixtures-$job/$page.html" --screenshots "$work/screenshots-$job"
done

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
run=("$job" "$source/examples/01-three-masses/case2.toml")
[[ $job != population ]] || run=(update "$source/examples/01-three-masses/case1.toml" --set 'update.method="maximum-likelihood"')
"$mottle" "${run[@]}" --out "$work/$job" --quiet
cd "$work/web"
node test/report_test.mjs "$work/$job/report.html" --screenshots "$work/screenshots-$job"
[[ $job != propagate ]] || exit 0
# Made-up data in the page that the program has just written: a structure; or every scale, many parameters, hardly any numbers.
pages=(modes shapes)
if [[ $job == population ]]; then
  pages=(population posterior old aeroplane sparse)
fi
node test/make_fixture.mjs "$work/fixtures-$job" "$work/$job/report.html"
for page in "${pages[@]}"; do
  node test/report_test.mjs "$work/fixtures-$job/$page.html" --screenshots "$work/screenshots-$job"
done

#!/usr/bin/env bash
# Runs a job of the first example and checks its report in a browser: run.sh JOB MOTTLE SOURCE_FOLDER WORK_FOLDER
set -euo pipefail
job=$1 mottle=$2 source=$3 work=$4
if ! command -v chromium >/dev/null; then
  echo "skipped: there is no chromium here (tools/install_packages.sh --test)"
  exit 77
fi
mkdir -p "$work/web"
cp -r "$source"/web/{package.json,package-lock.json,.npmrc,test} "$work/web/"
if [[ ! $work/web/node_modules/installed -nt $work/web/package-lock.json ]]; then
  (cd "$work/web" && npm ci --omit=optional --ignore-scripts --prefer-offline --no-progress --loglevel=error)
fi
touch "$work/web/node_modules/installed"
"$mottle" "$job" "$source/examples/01-three-masses/case2.toml" --out "$work/$job" --quiet
cd "$work/web"
node test/report_test.mjs "$work/$job/report.html" --screenshots "$work/screenshots-$job"
[[ $job == update ]] || exit 0
# Mode shapes of a made-up structure, in the page that the program has just written.
node test/make_fixture.mjs "$work/fixtures" "$work/$job/report.html"
for page in modes shapes; do
  node test/report_test.mjs "$work/fixtures/$page.html" --screenshots "$work/screenshots-modes"
done

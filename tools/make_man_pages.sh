#!/usr/bin/env bash
# Man pages of the command and of each of its subcommands, made by help2man of what they say with --help.
#   tools/make_man_pages.sh COMMAND FOLDER
set -euo pipefail
command=$1 folder=$2
mkdir -p "$folder"
rm -f "$folder"/mottle*.1.gz
version=$("$command" --version)
version=${version##* }
verbs=$("$command" --help | sed -n 's/^  \([a-z][a-z-]*\)  *[A-Za-z].*/\1/p')
[[ -n $verbs ]] || { echo "$0: '$command --help' lists no subcommands" >&2; exit 1; }

page() {  # NAME COMMAND: "name - summary" is the first line of the help
  local name=$1 summary
  summary=$($2 --help | head -1)
  help2man --no-info --no-discard-stderr --section=1 --manual="User Commands" --source="mottle $version" \
    --version-string="$name $version" --name="$summary" --output="$folder/$name.1" "$2"
  gzip -9n "$folder/$name.1"
}
page mottle "$command"
for verb in $verbs; do page "mottle-$verb" "$command $verb"; done

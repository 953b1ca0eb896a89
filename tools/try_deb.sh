#!/usr/bin/env bash
# Tries the Debian packages as a new user would: on a machine that has nothing but Debian's base system (debootstrap, chroot)
# apt installs them with what they depend on; the command runs an example of the package and makes its report, its man page
# is there, Python's module has the command's numbers, and with g++ and cmake the example of the library is built and run. Needs
# root, for chroot.
#   tools/try_deb.sh FOLDER-OF-PACKAGES
set -euo pipefail
packages=${1:?usage: tools/try_deb.sh FOLDER-OF-PACKAGES}
((EUID == 0)) || { echo "$0: chroot needs root; run it as root" >&2; exit 1; }
command -v debootstrap >/dev/null || { apt-get update -qq; apt-get install -q -y --no-install-recommends debootstrap >/dev/null; }

root=$(mktemp -d)
leave() {
  if mountpoint -q "$root/proc"; then umount "$root/proc"; fi
  rm -rf --one-file-system "$root"
}
trap leave EXIT

# The same mirrors as this machine's, so that the packages meet the versions that they were built with.
mapfile -t sources < <(apt-get indextargets --format '$(ORIGIN) deb $(REPO_URI) $(RELEASE) $(COMPONENT)' \
  'Created-By: Packages' | sort -u | sed -n 's/^Debian //p')
main=$(printf '%s\n' "${sources[@]}" | awk '$3 !~ /-/ { print; exit }')
read -r _ mirror release _ <<<"${main:?no mirror of Debian is known to apt}"
began=$SECONDS
# Where the mirror cannot be reached that way nothing is known of the packages: said, and no failure of theirs.
debootstrap --variant=minbase "$release" "$root" "$mirror" >"$packages/try_deb.log" 2>&1 ||
  { tail "$packages/try_deb.log"; echo "$0: NOT TRIED: no bare Debian can be made here"; exit 0; }
printf '%s\n' "${sources[@]}" >"$root/etc/apt/sources.list"
mount -t proc proc "$root/proc" || echo "$0: /proc cannot be mounted here; going on without it"
cp "$packages"/mottle_*.deb "$packages"/python3-mottle_*.deb "$packages"/libmottle-dev_*.deb "$root/tmp"
echo "bare Debian $release: $((SECONDS - began)) s"

inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive sh -euc "$1"; }
timed() {
  local what=$1 began=$SECONDS
  inside "$2" >>"$packages/try_deb.log" 2>&1 || { tail -40 "$packages/try_deb.log"; echo "$0: $what failed" >&2; exit 1; }
  echo "$what: $((SECONDS - began)) s"
}
timed "apt-get install ./mottle.deb" "apt-get update -qq; apt-get install -q -y /tmp/mottle_*.deb"
timed "mottle update of the package's example" "
  mottle --version
  gzip -t /usr/share/man/man1/mottle.1.gz
  mottle update /usr/share/doc/mottle/examples/01-three-masses/case1.toml --out /tmp/case1
  grep -q '\"status\": *\"converged\"' /tmp/case1/result.json
  test -s /tmp/case1/report.html"
timed "mottle update with the module for OpenTURNS" "
  mottle update /usr/share/doc/mottle/examples/01-three-masses/case1.toml --set 'update.sampling=\"sobol\"' --out /tmp/sobol
  grep -q '\"status\": *\"converged\"' /tmp/sobol/result.json"
timed "apt-get install ./python3-mottle.deb" "apt-get install -q -y --no-install-recommends /tmp/python3-mottle_*.deb"
timed "the same update in Python" "
  python3 -c '
import json, mottle
result = mottle.Study.read(\"/usr/share/doc/mottle/examples/01-three-masses/case1.toml\").update()
print(result)
command = json.load(open(\"/tmp/case1/result.json\"))[\"parameters\"][\"mean\"]
assert list(result.mean) == command, (list(result.mean), command)'"
timed "apt-get install ./libmottle-dev.deb g++ cmake make" "
  apt-get install -q -y --no-install-recommends /tmp/libmottle-dev_*.deb g++ cmake make"
timed "the library's example built and run" "
  cp -r /usr/share/doc/libmottle-dev/examples/06-cpp-library /tmp/library
  cmake -S /tmp/library -B /tmp/library/build
  cmake --build /tmp/library/build
  /tmp/library/build/own_model | grep adequate"

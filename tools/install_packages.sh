#!/usr/bin/env bash
# Installs the Debian packages that are missing: all that is needed to build, test, or check this repository.
#   tools/install_packages.sh [--run] [--build] [--test] [--deb] [--ci] [--clang] [--bench] [--python]     default: --build
# Each set includes what it stands on (all but --run include --build, --ci includes --test and --deb). Asks for root only if something is missing.
set -euo pipefail

# "package" or "package:command": a command on the PATH counts too (node and npm often come from elsewhere, and
# Debian's npm would conflict with them).
run=(libcholmod3 libfmt9 libhdf5-103-1 libmumps-seq-5.5 libopenblas0 libopenturns0.21 libre2-9 libtomlplusplus3 zlib1g)
build=(g++ make cmake ninja-build ca-certificates nodejs:node npm:npm
       libeigen3-dev libboost-dev libfmt-dev libhdf5-dev libmumps-seq-dev libopenblas0 libopenturns-dev
       librandom123-dev libre2-dev libsuitesparse-dev libtomlplusplus-dev
       libxxhash-dev nlohmann-json3-dev zlib1g-dev libcli11-dev)
test=(libgtest-dev libgmock-dev python3:python3 chromium:chromium calculix-ccx:ccx
      libopenmpi-dev openmpi-bin)
deb=(dpkg-dev file help2man:help2man)
ci=(clang-format:clang-format clang-tidy:clang-tidy gcovr:gcovr ccache:ccache slurm-wlm munge)
clang=(clang:clang++ libbenchmark-dev)
python=(pybind11-dev python3-dev python3-numpy python3-scipy python3-pandas python3-xarray python3-matplotlib
        python3-statsmodels python3-pytest python3-nbclient python3-nbconvert python3-ipykernel mypy:mypy)
bench=(libbenchmark-dev libspectra-dev octave python3:python3 python3-numpy python3-scipy python3-openturns python3-sklearn
       python3-petsc4py-real python3-slepc4py-real python3-emcee python3-matplotlib r-base-core r-cran-mcmc r-cran-posterior)

wanted=()
for set in "${@:---build}"; do
  case $set in
    --run) wanted+=("${run[@]}") ;;
    --build) wanted+=("${build[@]}") ;;
    --test) wanted+=("${build[@]}" "${test[@]}") ;;
    --deb) wanted+=("${build[@]}" "${deb[@]}") ;;
    --ci) wanted+=("${build[@]}" "${test[@]}" "${deb[@]}" "${ci[@]}") ;;
    --clang) wanted+=("${build[@]}" "${clang[@]}") ;;
    --python) wanted+=("${build[@]}" "${python[@]}") ;;
    --bench) wanted+=("${build[@]}" "${bench[@]}") ;;
    *) echo "usage: $0 [--run] [--build] [--test] [--deb] [--ci] [--clang] [--bench] [--python]; found '$set'" >&2; exit 2 ;;
  esac
done

if ! command -v apt-get dpkg-query >/dev/null; then
  echo "$0: no Debian here; the build goes on with what is installed. Debian's names of what it needs:" >&2
  echo "  ${wanted[*]%%:*}" >&2
  exit 0
fi

missing=()
for entry in "${wanted[@]}"; do
  package=${entry%%:*}
  if [[ $entry == *:* ]] && command -v "${entry#*:}" >/dev/null; then continue; fi
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then exit 0; fi

if ((EUID == 0)); then
  as_root=(env)
elif command -v sudo >/dev/null; then
  as_root=(sudo)
else
  echo "$0: these packages are missing, and installing them needs root (no sudo here). As root:" >&2
  echo "  apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
  exit 1
fi
echo "installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
# What there is to fetch, and a line for each 50 packages: a bare machine takes minutes, and silence looks like a hang.
"${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" |
  awk '/newly installed|Need to get|After this operation|^E:/ { print "  " $0 }
       /^Unpacking / && ++unpacked % 50 == 0 { print "  " unpacked " packages unpacked" }
       /^Setting up / && ++ready % 50 == 0 { print "  " ready " packages ready" }
       { fflush() }'

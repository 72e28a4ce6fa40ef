#!/usr/bin/env bash
# Checks what `make dist` built: packaging/check_dist.sh FOLDER.
set -euo pipefail
dist=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export PATH=$PWD/target/venv-dist/bin:$PATH
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

twine check --strict "$dist"/*.whl "$dist"/*[0-9].tar.gz
for wheel in "$dist"/*.whl; do
  shown=$(auditwheel show "$wheel")
  grep -q 'manylinux_2_17' <<<"$shown" || { echo "$wheel: not for glibc 2.17: $shown" >&2; exit 1; }
  abi3audit --strict "$wheel"
  python -m zipfile -e "$wheel" "$scratch/$(basename "$wheel")"
  test -s "$scratch/$(basename "$wheel")"/*.dist-info/licenses/THIRD-PARTY.txt
done
for archive in "$dist"/opm-*.tar.gz; do
  mkdir "$scratch/$(basename "$archive")"
  tar --extract --gzip --file "$archive" --directory "$scratch/$(basename "$archive")"
  if [ "$(find "$scratch/$(basename "$archive")" -mindepth 1 -maxdepth 1 | wc -l)" -ne 1 ]; then
    echo "$archive: more than one folder" >&2
    exit 1
  fi
done
# No path of the machine that built it. The folder of a build and the home are the two that could be in there.
if grep --recursive --files-with-matches --binary --fixed-strings -e "$PWD" -e "${CARGO_HOME:-$HOME/.cargo}/" "$scratch"; then
  echo "these files name a folder of this machine" >&2
  exit 1
fi

# Installed without the checkout, by every Python that is here.
machine=$(uname -m)
found=0
for python in ${PYTHONS:-python3.10 python3.11 python3.12 python3.13 python3.14}; do
  if ! "$python" -c 'import venv' 2>/dev/null; then continue; fi
  "$python" -m venv "$scratch/$python"
  "$scratch/$python/bin/python" -m pip install --quiet --no-warn-script-location --disable-pip-version-check \
    "$dist"/*"$machine".whl
  (cd "$scratch" && "$scratch/$python/bin/python" - <<'CODE'
import opm_kinematics as opm

m = opm.examples.load("plano-spherical-5dof")
assert m.inverse([m.home]).reachable.all()
CODE
    "$scratch/$python/bin/opm" licenses | grep -q 'Bitstream Vera')
  echo "$python: installed, and it solves a pose"
  found=$((found + 1))
done
test "$found" -gt 0 || { echo "no Python to install the wheel" >&2; exit 1; }

for archive in "$dist"/opm-*-linux-"$machine"*.tar.gz; do
  program=$(echo "$scratch/$(basename "$archive")"/*/opm)
  case $archive in
    *-static.tar.gz) ! ldd "$program" >/dev/null 2>&1 || ldd "$program" | grep -q 'statically linked' ;;
  esac
  "$program" decompose plano-spherical-5dof >/dev/null
  echo "$archive: it runs"
done
ls -l "$dist"

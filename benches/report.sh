#!/usr/bin/env bash
# Runs the benchmarks and writes their tables to BENCHMARKS.md, with the machine and the date.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tables=$(mktemp)
trap 'rm -f "$tables"' EXIT
"${CARGO:-cargo}" bench -p opm-benches | tee /dev/stderr >"$tables"

cpu=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1)
{
  cat <<EOF
# Benchmarks

Written by \`make bench\`. Things that are compared are timed in one run, turn and turn about, and the ratios are medians
over the rounds: on a machine that others use too, only these mean much.

* ${cpu:-$(uname -m)}, $(getconf _NPROCESSORS_ONLN) cores, $(uname -sm)
* $("${RUSTC:-rustc}" --version), release build
* $(date +%Y-%m-%d)

EOF
  awk '/^\|/ { print; table = 1; next } table { print ""; table = 0 } /^two threads/ { print; print "" }' "$tables"
} >BENCHMARKS.md

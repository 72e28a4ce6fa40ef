#!/bin/sh
# Runs the benchmarks and prints BENCHMARKS.md: `make bench`.
set -eu

if [ -r /proc/cpuinfo ]; then
  processor=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | sort -u | head -n 1)
else
  processor=$(sysctl -n machdep.cpu.brand_string 2>/dev/null || true)
fi
: "${PEERS_PYTHON:?a Python with opm_kinematics, NumPy and numba}"
OPM=${CARGO_TARGET_DIR:-$PWD/target}/release/opm
export PEERS_PYTHON OPM
"${CARGO:-cargo}" build --quiet --release --bin opm
results=$("${CARGO:-cargo}" bench --quiet -p opm-benches)
from_python=$("$PEERS_PYTHON" benches/peers/inverse.py && echo && "$PEERS_PYTHON" benches/peers/whole.py)

cat <<END
# Benchmarks

Written by \`make bench\` on $(date -u +%Y-%m-%d), opm $(git describe --always --dirty 2>/dev/null || echo "of an unknown commit").

* Processor: ${processor:-unknown}, $(getconf _NPROCESSORS_ONLN) logical
* System: $(uname -sm), $(rustc --version)

The contenders of a table were timed in one run, alternately. Each number is a median over the rounds; for inverse
kinematics from Python it is the best round. On another machine the times differ, but the ratios hardly do. The code is in
\`benches/benches\` and, for NumPy and numba, \`benches/peers\`.
END
# Puts a blank line between paragraphs and tables; a table begins one line above its rule.
printf '%s\n' "$results" "" "$from_python" | awk '
  NF { lines[++count] = $0 }
  END {
    for (i = 1; i <= count; i++) {
      row = lines[i] ~ /^\|/
      if (!row || !before || lines[i + 1] ~ /^\|-/) print ""
      print lines[i]
      before = row
    }
  }'

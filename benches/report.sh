#!/bin/sh
# Runs the benchmarks and prints BENCHMARKS.md: `make bench`.
set -eu

if [ -r /proc/cpuinfo ]; then
  processor=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | sort -u | head -n 1)
else
  processor=$(sysctl -n machdep.cpu.brand_string 2>/dev/null || true)
fi
: "${PEERS_PYTHON:?a Python with opm_kinematics, NumPy and numba}"
export PEERS_PYTHON
results=$("${CARGO:-cargo}" bench --quiet -p opm-benches -p opm-kinematics)

cat <<END
# Benchmarks

Written by \`make bench\` on $(date -u +%Y-%m-%d), opm $(git describe --always --dirty 2>/dev/null || echo "of no commit").

* Processor: ${processor:-unknown}, $(getconf _NPROCESSORS_ONLN) logical
* System: $(uname -sm), $(rustc --version)

What a table compares was timed in one run, turn and turn about; each number is a median over the rounds. On another
machine the times differ, the ratios hardly. The code is in \`benches/benches\`, \`cli/benches\` and, for NumPy and numba,
\`benches/peers\`.
END
# A blank line between paragraphs and tables; a table begins above its rule.
printf '%s\n' "$results" | awk '
  NF { lines[++count] = $0 }
  END {
    for (i = 1; i <= count; i++) {
      row = lines[i] ~ /^\|/
      if (!row || !before || lines[i + 1] ~ /^\|-/) print ""
      print lines[i]
      before = row
    }
  }'

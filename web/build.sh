#!/usr/bin/env bash
# Builds the explorer's page: crates/opm-web to WebAssembly, then web/src to one HTML file. It is written, compressed, to the
# file that is given, or to the place from which `opm explore` takes it.
# Needs node with npm, and a compiler for wasm32-unknown-unknown: the toolchain at hand with that target, or, where rustup
# cannot download it, Debian's packages rustc-web, rust-web-src and lld-19.
set -euo pipefail
page=$(realpath -m "${1:-$(dirname "${BASH_SOURCE[0]}")/../crates/opm-export/page/explorer.html.gz}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

target=wasm32-unknown-unknown
folder=$(realpath -m "${CARGO_TARGET_DIR:-target}/web")
wasm=$folder/$target/release/opm_web.wasm
build=(cargo rustc --locked --release --target "$target" --target-dir "$folder" -p opm-web --lib --crate-type cdylib)
# Files are read once, messages are written by hand, distances are those of one pose at a time: small is better there than fast.
for package in opm-mechanism opm-interference opm-analysis opm-accuracy opm-study opm-web parry3d-f64 toml toml_parser winnow serde_json; do
  build+=(--config "profile.release.package.$package.opt-level=\"s\"")
done
# Copies of the same generic code in several crates become one.
build+=(--config 'profile.release.lto="fat"')
# The names of functions are a twentieth of the code, and nobody reads them in a page.
last=(-- -C strip=symbols)

has_target() { [[ -d $(rustc --print target-libdir --target "$target" 2>/dev/null) ]]; }

if ! has_target && command -v rustup >/dev/null; then
  rustup target add "$target" || true
fi
if has_target; then
  RUSTFLAGS="-C target-feature=+simd128" "${build[@]}" "${last[@]}"
elif [[ -x /usr/bin/rustc ]] && command -v wasm-ld-19 >/dev/null; then
  # Debian's compiler for this build alone. It has no compiled standard library for the target, so that is built too.
  RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=wasm-ld-19 \
    RUSTFLAGS="-C target-feature=+simd128 -C linker-flavor=wasm-ld" \
    "${build[@]}" -Zbuild-std=std,panic_abort "${last[@]}"
else
  echo "no compiler for $target: rustup target add $target" >&2
  echo "on Debian, where that cannot download: apt-get install rustc-web rust-web-src lld-19" >&2
  exit 1
fi

# What is compiled into the page, for its list of licences.
cargo tree --locked -p opm-web --target "$target" -e normal --prefix none --format "{p} {l}" \
  | sed -e 's/ (\/[^)]*)//' -e 's/ (\*)$//' | grep -v '^opm-' | sort -u > "$folder/crates.txt"

cd web
# Nothing is fetched where the packages of the lock file are there already.
if ! npm ls --silent >/dev/null 2>&1; then
  npm ci --no-audit --no-fund --silent
fi
npm run --silent check
node build.mjs "$wasm" "$folder/crates.txt" "$page"

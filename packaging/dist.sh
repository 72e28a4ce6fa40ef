#!/usr/bin/env bash
# Builds what a release consists of, into target/dist, and checks it: `make dist`.
#
# The source distribution, and for each target that rustc has here: a wheel for every Python from 3.10 on, for systems with
# glibc 2.17 or later, linked with zig; and the program, without any library it would need if the target is musl's.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools=$PWD/target/venv-dist/bin
dist=$PWD/target/dist
export PATH=$tools:$PATH
rm -rf "$dist"
mkdir -p "$dist"

# No path of this machine is in what is built: neither that of the sources nor those of the crates and of the compiler.
home=${CARGO_HOME:-$HOME/.cargo}
maps="--remap-path-prefix=$PWD=opm --remap-path-prefix=$home=cargo --remap-path-prefix=$(rustc --print sysroot)=rust"
export RUSTFLAGS="${RUSTFLAGS:-} $maps"
# The C code of zstd is given the same names.
export CFLAGS="${CFLAGS:-} -ffile-prefix-map=$home=cargo -ffile-prefix-map=$PWD=opm"

version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)

has_target() {
  [ -d "$(rustc --print sysroot)/lib/rustlib/$1/lib" ] || rustup target add "$1" 2>/dev/null
}

maturin sdist --manifest-path py/Cargo.toml --out "$dist"
for target in ${TARGETS:-x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu}; do
  if has_target "$target"; then
    maturin build --release --locked --zig --compatibility manylinux_2_17 --target "$target" \
      --manifest-path py/Cargo.toml --out "$dist"
  else
    echo "dist: no wheel for $target: rustc has no such target here, and it cannot be added" >&2
  fi
done

program() {
  cargo zigbuild --release --locked -p opm-kinematics --bin opm --target "$1"
  tar --create --gzip --file "$dist/opm-$version-$2.tar.gz" --transform "s,.*/,opm-$version/," \
    --owner=0 --group=0 --numeric-owner \
    "${CARGO_TARGET_DIR:-target}/${1%.2.17}/release/opm" README.md LICENSE-MIT LICENSE-APACHE cli/THIRD-PARTY.txt
}
for machine in ${MACHINES:-x86_64}; do
  if has_target "$machine-unknown-linux-musl"; then
    program "$machine-unknown-linux-musl" "linux-$machine-static"
  else
    echo "dist: opm for $machine is not static: rustc has no $machine-unknown-linux-musl here" >&2
    program "$machine-unknown-linux-gnu.2.17" "linux-$machine"
  fi
done

exec packaging/check_dist.sh "$dist"

#!/usr/bin/env bash
# Builds what a release consists of, into target/dist, and checks it: `make dist`.
#
# The source distribution, and for each target that a compiler is here for: a wheel for every Python from 3.10 on, for systems
# with glibc 2.17 or later, linked with zig; and the program, without any library it would need.
#
# A target's standard library is that of rustc, or is added by rustup; or, where that cannot download, it is built from its
# sources by Debian's compiler: apt-get install rustc-web rust-web-src.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools=$PWD/target/venv-dist/bin
dist=$PWD/target/dist
export PATH=$tools:$PATH
rm -rf "$dist"
mkdir -p "$dist"

version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
given=${RUSTFLAGS:-}
debian=/usr/bin/rustc

# No path of this machine is in what is built: neither that of the sources nor those of the crates and of the compiler.
home=${CARGO_HOME:-$HOME/.cargo}
# The C code of zstd is given the same names.
export CFLAGS="${CFLAGS:-} -ffile-prefix-map=$home=cargo -ffile-prefix-map=$PWD=opm"

# Selects the compiler for a target; fails if there is none.
compiler_for() {
  unset RUSTC RUSTC_BOOTSTRAP CARGO_UNSTABLE_BUILD_STD
  local self=
  if ! [ -d "$(rustc --print sysroot)/lib/rustlib/$1/lib" ] && ! rustup target add "$1" 2>/dev/null; then
    [ -d "$("$debian" --print sysroot 2>/dev/null)/lib/rustlib/src/rust/library" ] || return 1
    export RUSTC=$debian RUSTC_BOOTSTRAP=1 CARGO_UNSTABLE_BUILD_STD=std,panic_unwind
    # The C library and its start files are zig's.
    case $1 in *-musl) self="-C link-self-contained=no" ;; esac
  fi
  local sysroot
  sysroot=$("${RUSTC:-rustc}" --print sysroot)
  export RUSTFLAGS="$given --remap-path-prefix=$PWD=opm --remap-path-prefix=$home=cargo --remap-path-prefix=$sysroot=rust $self"
}

maturin sdist --manifest-path py/Cargo.toml --out "$dist"
for target in ${TARGETS:-x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu}; do
  if compiler_for "$target"; then
    maturin build --release --locked --zig --compatibility manylinux_2_17 --target "$target" \
      --manifest-path py/Cargo.toml --out "$dist"
  else
    echo "dist: no wheel for $target: no compiler for it is here" >&2
  fi
done

program() {
  cargo zigbuild --release --locked -p opm-kinematics --bin opm --target "$1"
  tar --create --gzip --file "$dist/opm-$version-$2.tar.gz" --transform "s,^\(.*/\)*,opm-$version/," \
    --owner=0 --group=0 --numeric-owner \
    "${CARGO_TARGET_DIR:-target}/${1%.2.17}/release/opm" README.md LICENSE-MIT LICENSE-APACHE cli/THIRD-PARTY.txt
}
for machine in ${MACHINES:-x86_64}; do
  if compiler_for "$machine-unknown-linux-musl"; then
    program "$machine-unknown-linux-musl" "linux-$machine-static"
  elif compiler_for "$machine-unknown-linux-gnu"; then
    echo "dist: opm for $machine is not static: no compiler for $machine-unknown-linux-musl is here" >&2
    program "$machine-unknown-linux-gnu.2.17" "linux-$machine"
  fi
done

exec packaging/check_dist.sh "$dist"

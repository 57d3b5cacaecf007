#!/usr/bin/env bash
# Compiles voidwalk for systems that it is not developed on, and says how many errors each has:
#
#     scripts/checks/check_targets.sh          # cargo check: Windows, macOS, Linux on AArch64, and WebAssembly (the library without its faces)
#     scripts/checks/check_targets.sh run      # also built for AArch64 and Windows, and run in qemu-user and Wine: unit tests, and the scenes of
#                                       # same_bits.py, whose results must be those of x86-64 Linux to the last bit
#     scripts/checks/check_targets.sh run aarch64-unknown-linux-gnu     # one of them
#
# As root on Debian, and not part of .ci/run: a Debian trixie with a Rust of its own (1.96), whose source gives the standard library of
# every target, is made by debootstrap in VOIDWALK_TRIXIE (target/trixie: 4 GB, and ten minutes the first time). macOS is checked only:
# nothing here links for it.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=${VOIDWALK_TRIXIE:-$PWD/target/trixie}
what=${1:-check}
targets=${2:-x86_64-pc-windows-gnu aarch64-apple-darwin aarch64-unknown-linux-gnu wasm32-unknown-unknown}

make_root() {
    command -v debootstrap >/dev/null || { apt-get update && apt-get install -y --no-install-recommends debootstrap; }
    [ -x "$root/usr/bin/apt-get" ] || debootstrap --variant=minbase trixie "$root"
    cp /etc/resolv.conf /etc/hosts "$root/etc/"
    chroot "$root" dpkg --add-architecture arm64
    chroot "$root" apt-get update
    DEBIAN_FRONTEND=noninteractive chroot "$root" apt-get install -y --no-install-recommends \
        ca-certificates cargo-web gcc gcc-aarch64-linux-gnu gcc-mingw-w64-x86-64 libc6-dev libc6-dev-arm64-cross \
        libstd-rust-web-dev:arm64 python3 qemu-user rust-web-src rustc-web wine wine64
    # What this machine trusts, so does that one: crates may come through a proxy.
    cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
    touch "$root/made"
}
[ -e "$root/made" ] || make_root
mountpoint -q "$root/proc" || { mount -t proc proc "$root/proc" && trap 'umount "$root/proc"' EXIT; }

# The tree as it is here, with what is not yet committed.
rm -rf "$root/source" && mkdir "$root/source"
git ls-files --cached --others --exclude-standard | sort -u | while read -r file; do [ ! -e "$file" ] || echo "$file"; done |
    tar --create --files-from - | tar --extract --directory "$root/source"

# In there.
cat >"$root/work.sh" <<'SH'
set -eu
export CARGO_HOME=/cargo CARGO_TARGET_DIR=/built CARGO_TERM_COLOR=never HOME=/root RUSTC_BOOTSTRAP=1 WINEDEBUG=-all
# Walks need some optimisation, and their bits do not depend on how much.
export CARGO_PROFILE_DEV_OPT_LEVEL=1 CARGO_PROFILE_DEV_DEBUG=false
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64 -L /usr/aarch64-linux-gnu"
export CARGO_TARGET_X86_64_PC_WINDOWS_GNU_RUNNER=wine
what=$1 target=$2
cd /source
case $target in
aarch64-unknown-linux-gnu) std= ;; # Debian has it compiled
*) std=-Zbuild-std ;;
esac
case $target in
wasm32-*) part="--lib --no-default-features" ;;
*) part=--all-targets ;;
esac
# tests/ make links and pipes, as only Unix has them; and a crate of the tests is in C, for which there is no compiler for macOS.
case $target in *-windows-* | *-apple-*) part="--lib --bins" ;; esac
if cargo check --locked --quiet --target "$target" $std $part >"/log.$target" 2>&1; then errors=0; else
    errors=$(grep -E '^error(\[|:)' "/log.$target" | grep -vc 'could not compile' || true)
    cat "/log.$target" >&2
fi
echo "$target: $errors errors"
[ "$errors" = 0 ] || exit 1
[ "$what" = run ] || exit 0
case $target in
aarch64-unknown-linux-gnu) ending= runner=$CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER ;;
x86_64-pc-windows-gnu) ending=.exe runner=wine ;;
*) exit 0 ;;
esac
cargo build --locked --quiet --target "$target" $std
printf '#!/bin/sh\nexec %s /built/%s/debug/voidwalk%s "$@"\n' "$runner" "$target" "$ending" >"/voidwalk-$target"
chmod +x "/voidwalk-$target"
"/voidwalk-$target" --version
case $target in *-windows-*) python3 scripts/checks/try_windows.py --binary "/voidwalk-$target" ;; esac
python3 scripts/checks/same_bits.py --binary "/voidwalk-$target" check results/same-bits.json
cargo test --locked --quiet --target "$target" $std -p voidwalk-core --lib -- walk:: store:: stream::
SH
status=0
for target in $targets; do
    chroot "$root" bash /work.sh "$what" "$target" || status=1
done
exit $status

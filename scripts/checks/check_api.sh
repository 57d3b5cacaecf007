#!/usr/bin/env bash
# Whether the public interface of the library has changed since the last release (tag `v*`) by more than its version says:
#
#     scripts/checks/check_api.sh [COMMIT]      since this commit, if given
#
# Where there is no cargo-semver-checks, it is compiled into target/semver-checks, which takes minutes.
set -euo pipefail
cd "$(dirname "$0")/../.."
since=${1:-$(git describe --tags --abbrev=0 --match 'v*' 2>/dev/null || true)}
if [ -z "$since" ]; then
    echo "no release yet (no tag v*): there is nothing to compare with"
    exit 0
fi
if ! command -v cargo-semver-checks >/dev/null 2>&1; then
    [ -x target/semver-checks/bin/cargo-semver-checks ] ||
        cargo install --quiet --locked --root target/semver-checks cargo-semver-checks
    PATH=$PWD/target/semver-checks/bin:$PATH
fi
for crate in voidwalk-core voidwalk-sheets voidwalk-practice voidwalk-app voidwalk; do
    cargo semver-checks --package "$crate" --baseline-rev "$since"
done

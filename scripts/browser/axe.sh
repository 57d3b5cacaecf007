#!/bin/sh
# Looks for barriers on the page of `voidwalk serve` with axe-core: empty, with each example, with a batch that is walked (begun by
# keys) and one that is done, with a result, at 1280 and at 390 px, in the light and in the dark; and goes through it by the Tab key.
#
#   scripts/browser/axe.sh [BINARY]      target/release/voidwalk unless given
#
# axe-core comes from npm into target/axe, where it stays; none of it is committed. Fails where axe finds a violation, or where something
# that can be pressed cannot be reached by keys.
set -eu
cd "$(dirname "$0")/../.."
. scripts/browser/chromium.sh
have_commands chromium python3 npm
version=4.14.1
if [ ! -f "target/axe/package/axe.min.js" ]; then
    mkdir -p target/axe
    (cd target/axe && npm pack --silent "axe-core@$version" >/dev/null && tar -xzf "axe-core-$version.tgz")
fi
exec python3 scripts/browser/axe.py "${1:-target/release/voidwalk}" target/axe/package/axe.min.js target/axe/pictures

#!/usr/bin/env bash
# Builds the book of scripts/book into target/book/html/index.html:
#
#   scripts/book/book.sh [BINARY] [--update]      target/release/voidwalk unless given
#
# Runs every command of the tutorials, makes the pages of commands and settings from the binary, follows every link, and looks up every
# command, option and setting that a page names. Fails where a page says what is not so, or a link is dead. --update writes into the
# tutorials what the commands print now. mdBook (prebuilt) and what turns equations into MathML come from PyPI into
# target/book-environment, by their checksums; MDBOOK names another mdBook.
set -euo pipefail
cd "$(dirname "$0")/../.."
binary=target/release/voidwalk
if [ "$#" -gt 0 ] && [ "$1" != --update ]; then
    binary=$1
    shift
fi
environment=target/book-environment
if ! cmp -s scripts/book/requirements.txt $environment/requirements.txt; then
    rm -rf $environment
    "${PYTHON:-python3}" -m venv $environment
    $environment/bin/pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r scripts/book/requirements.txt
    cp scripts/book/requirements.txt $environment/
fi
PATH="$PWD/$environment/bin:$PATH" exec $environment/bin/python scripts/book/build.py "$binary" target/book "$@"

#!/bin/sh
# Opens a report in a headless Chromium, as a person would, and takes a picture of the whole page, or prints it.
#
#   scripts/browser/look_at_report.sh REPORT.html OUT.png [WIDTH [dark]]
#   scripts/browser/look_at_report.sh REPORT.html OUT.pdf [a4|letter]
#
# WIDTH is that of the window in pixels, 1280 unless given (390 is a telephone); dark sets the screen to dark colours. Fails when the page breaks its content
# security policy, logs an error, asks for any other file, is wider than the window, holds two labels that overlap in a
# figure or one that is cut off, when a box of a figure does not hide its curve or enlarge it, or when the picture is blank; in print, when the first page lacks verdict, warnings,
# rules or the places to sign, when Figure 1 is lettered below 7 pt, when a page has no number, when a page but the last is mostly empty, or when a word lies on itself. Installs Debian's chromium, and for
# print poppler-utils, when they are missing.
set -eu

if [ "$#" -lt 2 ] || [ "$#" -gt 4 ]; then
    echo "usage: $0 REPORT.html OUT.png [WIDTH [dark]], or OUT.pdf [a4|letter]" >&2
    exit 2
fi
[ -f "$1" ] || { echo "$1: no such file" >&2; exit 2; }
. "$(dirname "$0")/chromium.sh"

case $2 in
    *.pdf)
        how=${3:-a4}
        case $how in a4 | letter) ;; *) echo "$how: a4 or letter" >&2; exit 2 ;; esac
        have_commands chromium python3 pdftotext
        ;;
    *)
        how=${3:-1280}
        have_commands chromium python3
        ;;
esac
exec python3 "$(dirname "$0")/look_at_report.py" "$1" "$2" "$how" ${4:+"$4"}

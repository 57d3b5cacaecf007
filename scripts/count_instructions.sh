#!/bin/sh
# Instructions per particle-step of the portable kernel on a small fixed scene, counted by callgrind, so that
# a regression shows on a noisy machine. Writes results/walk-instructions-DATE.md.
# Usage: scripts/count_instructions.sh
set -eu
cd "$(dirname "$0")/.."
command -v valgrind >/dev/null || apt-get install -y valgrind
binary=$(cargo bench --bench compare_walk --no-run --message-format=json 2>/dev/null |
    sed -n 's/.*"name":"compare_walk".*"executable":"\([^"]*\)".*/\1/p' | tail -1)
counts() { # N UNTIL: instructions and attempted moves of a whole run
    line=$(RAYON_NUM_THREADS=1 valgrind --tool=callgrind --callgrind-out-file=/dev/null \
        "$binary" "$1" graded 1 "$2" 1 portable 2>target/callgrind.log)
    instructions=$(sed -n 's/.*Collected : \([0-9]*\).*/\1/p' target/callgrind.log)
    steps=$(echo "$line" | sed 's/^steps \([0-9]*\).*/\1/')
    echo "$instructions $steps"
}
# What both runs share (start, network, insertion) falls out of the difference.
set -- $(counts 50000 100) $(counts 50000 140)
out=results/walk-instructions-$(date +%F).md
mkdir -p results
{
    echo "# Instructions per particle-step, portable kernel"
    echo
    echo "Commit $(git rev-parse --short HEAD), $(rustc --version), valgrind $(valgrind --version | sed 's/valgrind-//')."
    echo "50 000 particles of the graded scene of \`benches/baseline\`, seed 1; whole increments, merge and tally included."
    echo
    echo "| increments | instructions | particle-steps | instructions a particle-step |"
    echo "|---|---|---|---|"
    awk -v i1="$1" -v s1="$2" -v i2="$3" -v s2="$4" 'BEGIN {
        printf "| 1-100, start, network and insertion included | %d | %d | %.2f |\n", i1, s1, i1 / s1
        printf "| 101-140, no insertion | %d | %d | %.2f |\n", i2 - i1, s2 - s1, (i2 - i1) / (s2 - s1)
    }'
} | tee "$out"

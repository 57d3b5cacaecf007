#!/bin/sh
# Instructions and cache misses per particle-step of the kernels that valgrind can run, on a small fixed scene, so that a
# regression shows on a noisy machine. Writes target/walk-instructions-DATE.md.
# Usage: scripts/studies/count_instructions.sh [NAME=BINARY ...]
# Each BINARY is an executable of the bench `compare_walk`; without one, that of this commit.
set -eu
cd "$(dirname "$0")/../.."
command -v valgrind >/dev/null || apt-get install -y valgrind
if [ $# = 0 ]; then
    binary=$(cargo bench --bench compare_walk --no-run --message-format=json 2>/dev/null |
        sed -n 's/.*"name":"compare_walk".*"executable":"\([^"]*\)".*/\1/p' | tail -1)
    set -- "$(git rev-parse --short HEAD)=$binary"
fi
counts() { # BINARY INSTRUCTIONS N UNTIL: attempted moves, instructions, accesses, misses of the first and the second cache
    line=$(RAYON_NUM_THREADS=1 valgrind --tool=callgrind --callgrind-out-file=/dev/null \
        --cache-sim=yes --D1=49152,12,64 --LL=1048576,16,64 \
        "$1" "$3" graded 1 "$4" 1 "$2" 2>target/callgrind.log)
    steps=$(echo "$line" | sed 's/^steps \([0-9]*\).*/\1/')
    # Collected : Ir Dr Dw I1mr D1mr D1mw ILmr DLmr DLmw
    sed -n 's/.*Collected : //p' target/callgrind.log |
        awk -v steps="$steps" '{ print steps, $1, $2 + $3, $5 + $6, $8 + $9 }'
}
out=target/walk-instructions-$(date +%F).md
mkdir -p results
{
    echo "# Instructions and cache misses per particle-step"
    echo
    echo "$(rustc --version), valgrind $(valgrind --version | sed 's/valgrind-//'), which has no AVX-512. The graded scene of \`benches/baseline\`, seed 1, one"
    echo "thread; whole increments, merge and tally included: increments 101 to 140, in which nothing is inserted. Caches as simulated: 48 kB and"
    echo "1 MB (the second level of a core); what is asked for ahead is not simulated, and counts as missed. 50,000 particles fit the second, 500,000 do not."
    echo
    echo "| build | kernel | particles | particle-steps | instructions a particle-step | data accesses | misses of the first cache | misses of the second |"
    echo "|---|---|---|---|---|---|---|---|"
    for n in 50000 500000; do
        for build in "$@"; do
            for isa in portable avx2; do
                # What both runs share (start, network, insertion) falls out of the difference.
                all="$(counts "${build#*=}" $isa $n 100) $(counts "${build#*=}" $isa $n 140)"
                awk -v build="${build%%=*}" -v isa=$isa -v n=$n -v all="$all" 'BEGIN {
                    split(all, v); steps = v[6] - v[1]
                    printf "| %s | %s | %d | %d |", build, isa, n, steps
                    for (i = 2; i <= 5; i++) printf " %.3g |", (v[i + 5] - v[i]) / steps
                    print ""
                }'
            done
        done
    done
} | tee "$out"

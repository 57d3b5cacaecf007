#!/bin/sh
# How the cost of a first run grows with base particles, voids and threads: writes target/walk-scaling-DATE.csv and two figures.
# Usage: scripts/studies/scale_walk.sh   (some ten minutes)
set -eu
cd "$(dirname "$0")/../.."
binary=$(cargo bench --bench scale_walk --no-run --message-format=json 2>/dev/null |
    sed -n 's/.*"name":"scale_walk".*"executable":"\([^"]*\)".*/\1/p' | tail -1)
out=target/walk-scaling-$(date +%F)
isa=portable
for try in avx2 avx512; do
    "$binary" counts 1 2 2 2 1 "$try" >/dev/null 2>&1 && isa=$try
done
echo "engine,n_base,nx,ny,nz,cu,threads,isa,wall_s,cpu_s,increments,moves,one_by_one,eroded,blocked,peak_mb" >"$out.csv"
run() { # ENGINE N NX NY NZ THREADS CU
    line=$(timeout 600 "$binary" "$1" "$2" "$3" "$4" "$5" "$6" "$isa" "$7" 2>/dev/null) || return 0
    echo "$line" | awk -v n="$2" -v x="$3" -v y="$4" -v z="$5" -v t="$6" -v cu="$7" -v isa="$isa" -v OFS=, \
        '{ print $2, n, x, y, z, cu, t, isa, $4, $6, $8, $10, $12, $14, $16, $18 }' | tee -a "$out.csv"
}
for threads in 1 2; do
    for n in 100000 1000000 10000000 100000000 200000000; do
        run particles $n 40 40 60 $threads 4.5
    done
    for n in 100000 1000000 10000000 100000000 200000000 1000000000 10000000000 100000000000; do
        run counts $n 40 40 60 $threads 4.5
    done
    for n in 100000 1000000 10000000 100000000 1000000000 10000000000 100000000000 1000000000000; do
        run counts $n 40 40 60 $threads 24
    done
done
for n in 100000 1000000 10000000 100000000 1000000000 10000000000; do
    run expected $n 40 40 60 1 4.5
done
for side in 10 20 40 80 160; do
    run counts $((side * side * side * 6250 / 3)) $side $side $side 1 4.5
    run particles 2000000 $side $side $side 1 4.5
done
run counts 3333333333 40 40 1000 1 4.5
run particles 2000000 40 40 1000 1 4.5
"$binary" draw "$out.csv" "$out"

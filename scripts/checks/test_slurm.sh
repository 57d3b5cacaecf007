#!/usr/bin/env bash
# Walks small campaigns on a private Slurm (scripts/slurm/private.sh, installed if it is missing), disturbs them, and compares
# each with the local run of the same plan, byte for byte apart from where and when:
#     scripts/checks/test_slurm.sh            # everything once, some two minutes
#     scripts/checks/test_slurm.sh 10         # the array and its disturbances ten times, and the counts
#     scripts/checks/test_slurm.sh 10 ""      # the array alone ten times; likewise "kill node"
set -euo pipefail
cd "$(dirname "$0")/../.."
rounds=${1:-1}
disturbances=${2-kill requeue controller node}
cargo build --release --workspace --bins --quiet
work=$(mktemp -d)
# A copy: a build meanwhile changes nothing.
voidwalk=$work/voidwalk
cp target/release/voidwalk "$voidwalk"
export VOIDWALK_SLURM=$work/slurm
# More tasks at a time than there may be processors: what is tested here is how they meet.
export VOIDWALK_SLURM_CPUS=8
private=scripts/slurm/private.sh
chmod 755 "$work"
trap '"$private" remove >/dev/null 2>&1 || true; rm -rf "$work"' EXIT
settings=$("$private" start)
eval "$settings"

fail() { # folder: what
    echo "FAILED: $*" >&2
    local folder=${1%%:*}
    tail -n 30 "$work/$folder"/slurm/*.log >&2 || true
    squeue >&2 || true
    exit 1
}

plan() { # seed
    # Names that a shell would act on, if one ever read them.
    cat >"$work/plan.toml" <<TOML
title = "Slurm against one machine"
seed = $1
[set]
replicates = 4
network = { nx = 20, ny = 20, nz = 30 }
record = { sensitivity = [], series_every = 0, size_curves = [] }
[[factor]]
name = "cu_b"
setting = "base.cu"
values = [1.5, 2, 3, 4.5]
[[factor]]
name = "filter; touch \$(echo hacked)"
[factor.levels]
loose = { "filter.curve" = "shire2016-cu1.5-loose" }
"dense \`touch hacked\` * & >hacked" = { "filter.curve" = "shire2016-cu1.5-dense", "base.dc_curve" = "shire2016-cu1.5-loose" }
[[factor]]
name = "d85_at_dc"
setting = "base.d85_at_dc"
values = [5, 25]
TOML
}

write() { # folder, options ...
    local folder=$1
    shift
    (cd "$work" && "$voidwalk" campaign plan.toml --out "$folder" --slurm --threads 1 "$@" >"$folder.said")
}

submit() { # folder
    sh "$work/$1/slurm/submit.sh" >/dev/null
}

logged() { cat "$work/$1"/slurm/*.log 2>/dev/null | grep -c "$2" || true; }

await() { # seconds, what, command ...
    local tenths=$((10 * $1)) what=$2
    shift 2
    until "$@"; do
        tenths=$((tenths - 1))
        [ "$tenths" -gt 0 ] || fail "$what: not within its time"
        sleep 0.1
    done
}

begun() { [ "$(logged "$1" '^begins: ')" -ge "$2" ]; }
idle() { [ -z "$(squeue -h 2>&1)" ]; }

# Ledger and table are those of the local run, apart from where and when.
same() { # folder
    local one
    for one in local "$1"; do sed 's/,"made":{[^}]*}}$/}/' "$work/$one/ledger.jsonl" >"$work/$one.ledger"; done
    cmp "$work/local.ledger" "$work/$1.ledger" || fail "$1: another ledger"
    cmp "$work/local/cases.csv" "$work/$1/cases.csv" || fail "$1: another table"
    cmp "$work/local/campaign.json" "$work/$1/campaign.json" || fail "$1: another campaign.json"
    [ -z "$(find "$work" -name 'hacked*')" ] || fail "a name was taken for a command"
}

# A process of a task that is walking now; the cases' folder names it.
walker() { # folder
    local pid
    for pid in $(pgrep -x voidwalk || true); do
        if tr '\0' ' ' <"/proc/$pid/cmdline" 2>/dev/null | grep -qF -- "$work/$1 --task"; then
            echo "$pid"
            return
        fi
    done
    fail "$1: no task is walking"
}

task_of() { tr '\0' '\n' <"/proc/$1/environ" | sed -n 's/^SLURM_ARRAY_TASK_ID=//p'; }
array_of() { tr '\0' '\n' <"/proc/$1/environ" | sed -n 's/^SLURM_ARRAY_JOB_ID=//p'; }

declare -A counts
count() { counts[$1]=$((${counts[$1]:-0} + ${2:-1})); }

# Submits the plan, does something to it in the middle, and compares what came of it.
disturbed() { # folder, what
    local folder=$1 what=$2 pid
    write "$folder" --tasks 4 --checkpoint-every 100ms
    submit "$folder"
    await 30 "$what: first cases" begun "$folder" $((1 + RANDOM % 5))
    sleep "0.$((RANDOM % 10))"
    case $what in
        kill) kill -KILL "$(walker "$folder")" ;;
        requeue) pid=$(walker "$folder"); scontrol requeue "$(array_of "$pid")_$(task_of "$pid")" ;;
        controller) "$private" stop-controller; sleep 1; "$private" start-controller ;;
        node) "$private" kill-node; sleep 1; "$private" start-node ;;
    esac
    await 90 "$what: end of the jobs" idle
    same "$folder"
    count "$what: campaigns"
    count "$what: attempts at tasks" "$(logged "$folder" 'attempt ')"
    count "$what: walks begun" "$(logged "$folder" '^begins: ')"
    count "$what: walks gone on with" "$(logged "$folder" '^continues: ')"
    case $what in
        kill | requeue) [ "$(logged "$folder" 'attempt 2 ')" -ge 1 ] || fail "$what: no second attempt" ;;
    esac
    echo "$what: the same ledger and tables; $(logged "$folder" 'attempt ') attempts at 4 tasks, $(logged "$folder" '^begins: ') walks begun," \
        "$(logged "$folder" '^continues: ') gone on with"
    rm -rf "${work:?}/$folder"
}

commit=
for round in $(seq "$rounds"); do
    plan "$round"
    RANDOM=$round
    (cd "$work" && rm -rf local && "$voidwalk" campaign plan.toml --out local --quiet)
    commit=$(sed -n '1s/.*"commit":"\([^"]*\)".*/\1/p' "$work/local/ledger.jsonl")

    # An array as it is: every case is begun once.
    write array --tasks 6
    submit array
    await 60 "array: end of the jobs" idle
    same array
    [ "$(logged array '^begins: ')" = 16 ] || fail "array: $(logged array '^begins: ') walks begun for 16 cases"
    grep -q '"job":"[0-9]*_[0-9]*"' "$work/array/ledger.jsonl" || fail "array: the ledger names no task"
    count "undisturbed: campaigns"
    count "undisturbed: attempts at tasks" "$(logged array 'attempt ')"
    count "undisturbed: walks begun" 16
    echo "array: the same ledger and tables, 16 walks begun for 16 cases"
    rm -rf "$work/array"

    for what in $disturbances; do disturbed "$what" "$what"; done
done

# Two arrays of one plan at once, bundled differently: every case is walked once.
write twice --tasks 4
submit twice
write twice --tasks 3
submit twice
await 90 "twice: end of the jobs" idle
same twice
[ "$(logged twice '^begins: ')" = 16 ] || fail "twice: $(logged twice '^begins: ') walks begun for 16 cases"
[ "$(logged twice 'attempt 1 ')" = 7 ] || fail "twice: $(logged twice 'attempt 1') tasks"
echo "two arrays at once: 16 walks begun for 16 cases, $(logged twice '^waits: ') times a task waited for one of the other array"
[ "$(logged twice '^waits: ')" -ge 1 ] || fail "twice: the arrays did not meet"

# Cancelled: nothing comes back, the collecting job says what is missing, and submitting again goes on.
write cancelled --tasks 4
submit cancelled
await 30 "cancelled: first cases" begun cancelled 2
scancel --name=voidwalk
await 90 "cancelled: end of the jobs" idle
grep -q 'refused: .* of 16 cases are missing' "$work"/cancelled/slurm/collect-*.log || fail "cancelled: collected all the same"
[ ! -e "$work/cancelled/ledger.jsonl" ] || fail "cancelled: a ledger was written"
[ "$(logged cancelled 'attempt 2')" = 0 ] || fail "cancelled: a task came back"
write cancelled --tasks 2
submit cancelled
await 90 "cancelled: end of the jobs" idle
same cancelled
echo "cancelled, then submitted again: the same ledger and tables"

# A case that cannot be walked: the others are, and it is named.
write bad --tasks 2
mkdir -p "$work/bad/cases"
name=$(cd "$work" && "$voidwalk" campaign plan.toml --list | tail -n 1)
touch "$work/bad/cases/$(sed -n '$s/.*"folder":"cases.\([^"]*\)".*/\1/p' "$work/local/ledger.jsonl")"
submit bad
await 90 "bad: end of the jobs" idle
[ "$(find "$work/bad/cases" -name case.json | wc -l)" = 15 ] || fail "bad: the other cases are not done"
grep -qF "case $name: could not be walked" "$work"/bad/slurm/collect-*.log || fail "bad: the case is not named"
echo "one bad case: 15 of 16 done, and it is named"

# Filters that are packed: each once, before the walks.
cat >"$work/plan.toml" <<'TOML'
[set]
replicates = 2
network = { nx = 8, ny = 8, nz = 10 }
packing = { grains = 400, stiffness_ratio = 0.01 }
record = { sensitivity = [], series_every = 0, size_curves = [] }
[[factor]]
name = "density"
[factor.levels]
loose = { filter = { cu = 1.5, density = "loose" } }
dense = { filter = { cu = 1.5, density = "dense" } }
[[factor]]
name = "cu_b"
setting = "base.cu"
values = [1.5, 3]
TOML
(cd "$work" && rm -rf local && "$voidwalk" campaign plan.toml --out local --quiet)
write packed --tasks 2
submit packed
await 90 "packed: end of the jobs" idle
same packed
[ "$(logged packed '^packing 400 grains')" = 2 ] || fail "packed: $(logged packed '^packing 400 grains') packings made"
echo "packings: the same ledger and tables, 2 packings made for 4 cases"

# Any other engine: GNU parallel, where it is there; failed cases and only those are run again.
if command -v parallel >/dev/null && parallel --version 2>/dev/null | grep -q GNU; then
    (cd "$work" && "$voidwalk" campaign plan.toml --list |
        parallel --will-cite --joblog jobs.log --resume-failed "$voidwalk" campaign plan.toml --out parallel --threads 1 --quiet --case={} &&
        "$voidwalk" campaign plan.toml --out parallel --collect --quiet)
    same parallel
    echo "GNU parallel: the same ledger and tables"
fi

[ "$rounds" -gt 1 ] || exit 0
echo "$(date -u +%F), $(sinfo --version), one node of $(nproc) processors, commit $commit, seeds 1 to $rounds, 16 cases a campaign:"
for name in "${!counts[@]}"; do echo "  $name: ${counts[$name]}"; done | sort

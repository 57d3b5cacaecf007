#!/bin/sh
# One attempt at a task: sh attempt.sh PROGRAM ARGUMENT...
# Hands SIGTERM on to the program, which keeps its walks and ends with exit code 3, and puts the task back into the queue
# where it can go on: after that, and after a kill that was not Slurm's (out of memory, a crash).
# VOIDWALK_RESTARTS (100) and VOIDWALK_RESTARTS_AFTER_KILL (5) say how often at most.
task=$SLURM_JOB_ID
# An array's number alone would stand for all of its tasks.
[ -z "${SLURM_ARRAY_TASK_ID:-}" ] || task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
restarts=${SLURM_RESTART_COUNT:-0}
say() { echo "$(date '+%F %T') task $task: $*"; }

say "attempt $((restarts + 1)) on $(hostname)"
child=
asked=
trap 'asked=yes; [ -z "$child" ] || kill -TERM "$child" 2>/dev/null' TERM
"$@" </dev/null &
child=$!
[ -z "$asked" ] || kill -TERM "$child" 2>/dev/null
# A signal ends `wait` before the program has ended.
while wait "$child"; code=$?; [ "$code" -gt 128 ] && kill -0 "$child" 2>/dev/null; do :; done

case $code in
    0) say "done"; exit 0 ;;
    3) most=${VOIDWALK_RESTARTS:-100} ;;
    129 | 13? | 14? | 15?) most=${VOIDWALK_RESTARTS_AFTER_KILL:-5} ;;
    *) say "ended with exit code $code"; exit "$code" ;;
esac
say "ended with exit code $code; what is done is kept"
if [ "$restarts" -ge "$most" ]; then
    say "has been begun again $restarts times: that is enough"
    exit "$code"
fi
# A task that is cancelled, or that Slurm itself puts back, is not running any more: it is left alone.
for try in 1 2 3 4 5 6; do
    case $(scontrol -o show job "$task" 2>/dev/null) in
        *JobState=RUNNING*)
            if scontrol requeue "$task"; then
                say "is back in the queue"
                exit "$code"
            fi ;;
        *JobState=*) say "is ended by Slurm"; exit "$code" ;;
    esac
    sleep $((2 * try))
done
say "cannot be put back into the queue; submit the scripts again to go on"
exit "$code"

#!/usr/bin/env bash
# A private Slurm on one machine, to try campaigns on:
#     eval "$(scripts/slurm/private.sh start)"     # installs it if it is missing (Debian, as root), starts it, sets SLURM_CONF
#     sinfo; sbatch ...; squeue
#     scripts/slurm/private.sh stop                # stops its daemons and cancels its jobs
#     scripts/slurm/private.sh remove              # the same, and removes its files
# and for tests: stop-controller, start-controller, kill-node (slurmd alone, as a crash would), start-node.
#
# It lives in VOIDWALK_SLURM (default: /tmp/voidwalk-slurm-UID) with ports, key and socket of its own. Another Slurm of the
# machine is left alone: its daemons are not touched, its configuration is not read, and nothing is installed where part
# of a Slurm is there already. It needs no systemd, runs as root in a container or as a user, and a second `start` does nothing.
# VOIDWALK_SLURM_CPUS says how many processors it claims to have (default: those there are, at least 2).
set -euo pipefail
home=${VOIDWALK_SLURM:-/tmp/voidwalk-slurm-$(id -u)}
conf=$home/slurm.conf
mark='# private Slurm of voidwalk'
PATH=$PATH:/usr/sbin:/sbin
unset SLURM_CONF

say() { echo "$*" >&2; }

install() {
    local missing=() there=() program
    for program in munged slurmctld slurmd sbatch; do
        if command -v "$program" >/dev/null; then there+=("$program"); else missing+=("$program"); fi
    done
    [ ${#missing[@]} = 0 ] && return
    case " ${there[*]:-} " in
        *" slurm"* | *" sbatch "*)
            say "this machine has ${there[*]} but not ${missing[*]}: nothing is added to a Slurm that is there"
            exit 1 ;;
    esac
    command -v apt-get >/dev/null || { say "needs Debian's packages slurm-wlm and munge (missing: ${missing[*]})"; exit 1; }
    [ "$(id -u)" = 0 ] || { say "run as root once, or: sudo apt-get install slurm-wlm munge"; exit 1; }
    # The packages' own daemons are not to start.
    local policy=/usr/sbin/policy-rc.d made=
    if [ ! -e "$policy" ]; then
        printf '#!/bin/sh\nexit 101\n' >"$policy" && chmod +x "$policy" && made=yes
    fi
    say "installing slurm-wlm and munge"
    local log code=0
    log=$(mktemp)
    export DEBIAN_FRONTEND=noninteractive
    { apt-get install -y --no-install-recommends slurm-wlm munge ||
        { apt-get update && apt-get install -y --no-install-recommends slurm-wlm munge; }; } >"$log" 2>&1 || code=$?
    [ -z "$made" ] || rm -f "$policy"
    [ "$code" = 0 ] || { cat "$log" >&2; exit 1; }
    rm -f "$log"
}

# The process of a pid file, if it is there and is ours.
alive() { # program
    local pid
    pid=$(cat "$home/$1.pid" 2>/dev/null) && [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = "$1" ] && echo "$pid"
}

await() { # seconds, what, command ...
    local tenths=$((10 * $1)) what=$2
    shift 2
    until "$@" >/dev/null 2>&1; do
        tenths=$((tenths - 1))
        [ "$tenths" -gt 0 ] || { say "$what: not within its time; see $home/*.log"; exit 1; }
        sleep 0.1
    done
}

free_port() { # first
    local port=$1
    while (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((port + 1)); done
    echo "$port"
}

configure() {
    mkdir -p "$home"
    [ -O "$home" ] || { say "$home belongs to somebody else"; exit 1; }
    if [ -f "$conf" ] && ! grep -q "^$mark" "$conf"; then
        say "$conf is of another Slurm: name another folder in VOIDWALK_SLURM"
        exit 1
    fi
    chmod 755 "$home"
    mkdir -p "$home/state" "$home/spool"
    if [ ! -f "$home/munge.key" ]; then
        (umask 077 && dd if=/dev/urandom of="$home/munge.key" bs=1024 count=1 2>/dev/null && chmod 400 "$home/munge.key")
    fi
    local cpus memory ctld_port d_port
    cpus=${VOIDWALK_SLURM_CPUS:-$(nproc)}
    [ "$cpus" -ge 2 ] || cpus=2
    memory=$(awk '/^MemTotal/ {print int($2 / 1024 * 0.9)}' /proc/meminfo)
    ctld_port=$(free_port 26817)
    d_port=$(free_port 26917)
    # cred_expire: a job that is requeued waits this long before it may start again (two minutes by default).
    cat >"$conf" <<CONF
$mark
ClusterName=private
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$ctld_port
SlurmdPort=$d_port
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$home/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation=$home/state
SlurmdSpoolDir=$home/spool
SlurmctldPidFile=$home/slurmctld.pid
SlurmdPidFile=$home/slurmd.pid
SlurmctldLogFile=$home/slurmctld.log
SlurmdLogFile=$home/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0,bf_interval=2
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=10
SlurmdTimeout=30
SlurmctldTimeout=30
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=$memory State=UNKNOWN
PartitionName=private Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
}

start_munge() {
    [ -n "$(alive munged)" ] && return
    rm -f "$home/munge.socket" "$home/munge.socket.lock"
    munged --key-file="$home/munge.key" --socket="$home/munge.socket" --pid-file="$home/munged.pid" \
        --log-file="$home/munged.log" --seed-file="$home/munge.seed" 2>/dev/null ||
        munged --force --key-file="$home/munge.key" --socket="$home/munge.socket" --pid-file="$home/munged.pid" \
            --log-file="$home/munged.log" --seed-file="$home/munge.seed"
    await 10 munged test -S "$home/munge.socket"
}

start_controller() {
    [ -n "$(alive slurmctld)" ] || slurmctld -f "$conf" >/dev/null
    SLURM_CONF=$conf await 20 slurmctld scontrol ping
}

up() { SLURM_CONF=$conf sinfo -h -o %t | grep -Eq '^(idle|mix|alloc|comp)$'; }

start_node() {
    [ -n "$(alive slurmd)" ] || slurmd -f "$conf" -N "$(hostname -s)" >/dev/null
    await 40 "the node" up
}

end() { # program, signal
    local pid
    pid=$(alive "$1") || return 0
    kill "-$2" "$pid" || return 0
    await 20 "end of $1" test ! -d "/proc/$pid"
}

# Job steps outlive slurmd: they are children of slurmstepd, which only our own slurmd has started here.
end_steps() {
    local pid
    for pid in $(pgrep -x slurmstepd || true); do
        if grep -qs "$conf" "/proc/$pid/environ" "/proc/$pid/cmdline"; then kill -TERM "$pid" || true; fi
    done
}

stop() {
    [ -f "$conf" ] || return 0
    if [ -n "$(alive slurmctld)" ]; then
        SLURM_CONF=$conf timeout 10 scancel --me 2>/dev/null || true
        for _ in $(seq 50); do
            [ -n "$(SLURM_CONF=$conf timeout 5 squeue -h 2>/dev/null)" ] || break
            sleep 0.2
        done
    fi
    end slurmd TERM
    end_steps
    end slurmctld TERM
    end munged TERM
}

case ${1:-} in
    start)
        install
        if [ -z "$(alive slurmctld)" ] && [ -z "$(alive slurmd)" ]; then configure; fi
        start_munge
        start_controller
        start_node
        echo "export SLURM_CONF='$conf'" ;;
    stop) stop ;;
    remove) stop; if grep -qs "^$mark" "$conf"; then rm -rf "$home"; fi ;;
    stop-controller) end slurmctld TERM ;;
    start-controller) start_controller ;;
    kill-node) end slurmd KILL ;;
    start-node) start_node ;;
    *) say "usage: $0 start | stop | remove | stop-controller | start-controller | kill-node | start-node"; exit 2 ;;
esac

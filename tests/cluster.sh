#!/usr/bin/env bash
# One study over many machines: a whole Slurm on this one, GNU parallel, and Dask. Each case must give, byte for byte, what one
# run gives: an array and its merge, a time limit and what is put back, a node that is killed, a worker that is killed, jobs that
# are stopped, a stop over shards, a sweep, a sweep whose points stop by their rule.
#   tests/cluster.sh         TAUTLINE names another binary than the release build, TAUTROPE another wheel than that of it
# What cannot be had it installs, if there is apt-get, or pip. Where that does not help it says which cases did not run, and fails
# if SCHEDULERS, such as "slurm parallel dask", names them.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ -z "${TAUTLINE:-}" ]; then
    cargo build --release --quiet --bin tautline
    TAUTLINE=target/release/tautline
fi
TAUTLINE=$(realpath "$TAUTLINE")
export TAUTLINE NODEVICE_SELECT=1 RAYON_NUM_THREADS=1
work=$(mktemp -d /tmp/cluster.XXXXXX)
pids=()
passed=0 failed=0 left_out=() promised=" ${SCHEDULERS:-} "
say() { printf '%4d s  %s\n' "$SECONDS" "$*"; }

# Everything that was started is ended by its own number.
tidy() {
    local file pid
    command -v scancel >/dev/null && [ -e "$work/slurm.conf" ] && timeout 10 scancel -u "$(id -un)" 2>/dev/null || true
    # Those who watch over a job end with it; who is left, of a lost node, is known by the folder in which it works.
    [ ! -e "$work/slurm.conf" ] || sleep 3
    for file in /proc/[0-9]*/cwd; do
        case $(readlink "$file" 2>/dev/null || true) in
        "$work" | "$work"/*) pid=${file%/cwd} && pids+=("${pid#/proc/}") ;;
        esac
    done
    for file in "$work"/*.pid; do
        if [ -e "$file" ]; then pids+=("$(cat "$file")"); fi
    done
    for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
    sleep 1
    for pid in "${pids[@]}"; do kill -9 "$pid" 2>/dev/null || true; done
    # What a killed node or worker left running holds the lease of its folder.
    sed -n 's/.*"process":\([0-9]*\).*/\1/p' "$work"/*/part-*/lease.* 2>/dev/null | xargs -r kill -9 2>/dev/null || true
    rm -rf "$work"
}
trap tidy EXIT
trap "exit 1" INT TERM

same() { # same CASE FOLDER TRUTH
    if cmp -s "$work/$2/summary.json" "$work/$3/summary.json"; then
        passed=$((passed + 1))
        say "$1: the same bytes"
    else
        failed=$((failed + 1))
        say "FAILED: $1"
        tail -n 5 "$work/${2%/*}"/*.log 2>/dev/null || true
    fi
}
same_sweep() { # same_sweep CASE FOLDER TRUTH
    local file
    for file in sweep.csv sweep.parquet sweep.svg point-000/summary.json point-001/summary.json point-002/summary.json; do
        if ! cmp -s "$work/$2/$file" "$work/$3/$file"; then
            failed=$((failed + 1))
            say "FAILED: $1, $file"
            tail -n 5 "$work/${2%/*}"/*.log 2>/dev/null || true
            return
        fi
    done
    passed=$((passed + 1))
    say "$1: the same bytes"
}
spared() { # spared CASE: that its parts have not done all blocks
    local told
    # Numbers above a thousand have commas.
    told=$("$TAUTLINE" study status "$work/$1"/part-*/ | tr -d , | sed -n '1s/.*: \([0-9]*\) of \([0-9]*\) blocks done.*/\1 \2/p')
    if [ "${told% *}" -lt "${told#* }" ]; then
        say "${told% *} of ${told#* } blocks were done for it"
    else
        failed=$((failed + 1))
        say "FAILED: $1: all ${told#* } blocks were done, though fewer were enough"
    fi
}
wait_for() { # wait_for SECONDS COMMAND...
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.2
    done
}

root=()
[ "$(id -u)" -eq 0 ] || root=(sudo -n)
install() { # install PACKAGES...
    command -v apt-get >/dev/null || return 0
    say "installing $*"
    "${root[@]}" apt-get update -qq >/dev/null 2>&1 || true
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null 2>&1 || true
}
did_not_run() { # did_not_run NAME WHY
    left_out+=("$1: $2")
    case $promised in *" $1 "*) failed=$((failed + 1)) && say "FAILED: $1 was to run" ;; esac
}
has_slurm() { command -v slurmctld && command -v slurmd && command -v sbatch && command -v munged; }
has_slurm >/dev/null || install slurmctld slurmd slurm-client munge
# Another program of that name is in the package moreutils.
has_parallel() { parallel --version 2>/dev/null | grep -q "^GNU parallel"; }
has_parallel || install parallel

# The studies, and what one run says. One takes long enough that something can happen meanwhile.
study() { # study NAME TRACES UNTIL
    printf '%s\n' '[scene]' 'built_in = "rooms"' '[walk]' 'kind = "persistent"' 'step = 0.4' 'steps = 60' \
        '[outputs]' 'pictures = false' '[run]' 'block = 500' "traces = $2" "${3:-}" >"$work/$1.toml"
}
study short 12000
"$TAUTLINE" study run "$work/short.toml" --out "$work/short" --engine cpu >/dev/null 2>&1
# So many traces as one part of three does in some 20 seconds.
start=$(date +%s%N)
"$TAUTLINE" study run "$work/short.toml" --seed 2 --out "$work/pace" --engine cpu >/dev/null 2>&1
pace=$((12000 * 1000000000 / ($(date +%s%N) - start)))
study long $((pace * 24 / 500 * 500))
study rule $((pace * 40 / 500 * 500)) $'[until]\nrelative_error = 0.01'
study sweep 6000 $'[sweep]\nwalk.step = [0.3, 0.4, 0.5]'
study rules 20000 $'[until]\nrelative_error = 0.02\n[sweep]\nwalk.step = [0.2, 0.4, 0.6]'
say "one run, about $pace traces a second"
(RAYON_NUM_THREADS=2 "$TAUTLINE" study run "$work/long.toml" --out "$work/long" --engine cpu >/dev/null 2>&1) &
truth=$!
"$TAUTLINE" study run "$work/rule.toml" --out "$work/rule" --engine cpu >/dev/null 2>&1
"$TAUTLINE" study run "$work/sweep.toml" --out "$work/sweep" --engine cpu >/dev/null 2>&1
"$TAUTLINE" study run "$work/rules.toml" --out "$work/rules" --engine cpu >/dev/null 2>&1
wait "$truth"
say "the truth is there"

write() { # write SCHEDULER STUDY CASE PARTS [TIME]
    "$TAUTLINE" study script "$1" "$work/$2.toml" --parts "$4" --out "$work/$3" --to "$work/$3.script" \
        --time "${5:-60m}" --engine cpu >/dev/null 2>&1
}

begin_slurm() {
    local host
    host=$(hostname)
    cat >"$work/slurm.conf" <<CONF
ClusterName=tautline
SlurmctldHost=$host(127.0.0.1)
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPort=26817
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket,cred_expire=15
CryptoType=crypto/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool.%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.%n.pid
SlurmctldLogFile=$work/slurmctld.daemon
SlurmdLogFile=$work/slurmd.%n.daemon
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=20
KillWait=10
MinJobAge=600
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobRequeue=1
SlurmdParameters=config_overrides
NodeName=n[1-3] NodeHostname=$host NodeAddr=127.0.0.1 Port=[26821-26823] CPUs=3 RealMemory=4000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
    export SLURM_CONF=$work/slurm.conf
    mkdir "$work/state"
    chmod 755 "$work"
    dd if=/dev/urandom of="$work/munge.key" bs=128 count=1 2>/dev/null
    chmod 400 "$work/munge.key"
    munged --key-file="$work/munge.key" --socket="$work/munge.socket" --pid-file="$work/munged.pid" \
        --log-file="$work/munged.daemon" --seed-file="$work/munged.seed" --force || return 1
    slurmctld -c || return 1
    for n in n1 n2 n3; do slurmd -N "$n" || return 1; done
    wait_for 10 bash -c 'sinfo -h -o %T | grep -qx idle'
}
over() { ! squeue -h -o %j | grep -q .; }

if [ "$(id -u)" -eq 0 ] && has_slurm >/dev/null && begin_slurm >"$work/slurm.begin" 2>&1; then
    say "Slurm $(sbatch --version | cut -d' ' -f2), three nodes"
    write slurm short array 6
    write slurm long limit 3
    write slurm rule stop 8
    write slurm rules stops 4
    # As if the job's end were nearer than a minute, which is the least that Slurm knows.
    sed -i 's/--stop-before [0-9]*s/--stop-after 4s/' "$work/limit.script"
    sed -i 's/--stop-after 60s/--stop-after 6s/' "$work/stop.script"
    sed -i 's/--stop-after 60s/--stop-after 3s/' "$work/stops.script"
    write slurm long lost 3
    bash "$work/array.script" >/dev/null
    wait_for 300 over || true
    same "Slurm, an array and its merge" array/all short
    write slurm sweep swept 4
    bash "$work/swept.script" >/dev/null
    wait_for 300 over || true
    same_sweep "Slurm, a sweep" swept/all sweep
    bash "$work/stops.script" >/dev/null
    wait_for 300 over || true
    same_sweep "Slurm, a sweep whose points stop by their rule" stops/all rules
    bash "$work/lost.script" >/dev/null
    bash "$work/limit.script" >/dev/null
    bash "$work/stop.script" >/dev/null
    wait_for 20 test -e "$work/lost/part-3/state.bin" || true
    node=$(squeue -h -r -t R -n tautline -o '%N %o' | grep lost | head -n 1 | cut -d' ' -f1)
    say "killing slurmd on $node"
    kill -9 "$(cat "$work/slurmd.$node.pid")"
    wait_for 45 bash -c "sinfo -h -N -o '%N %T' | grep -q '$node down'" || say "the node is not noticed as down"
    slurmd -N "$node"
    wait_for 900 over || { say "still in the queue:"; squeue; }
    same "Slurm, a time limit and what is put back" limit/all long
    grep -q 'are saved: go on' "$work"/limit/part-*.log || { failed=$((failed + 1)); say "FAILED: no part was stopped in time"; }
    same "Slurm, a node that is killed" lost/all long
    same "Slurm, a stop over shards" stop/all rule
    spared stop
else
    did_not_run slurm "its packages, or the right to start it, are missing: $(tail -n 1 "$work/slurm.begin" 2>/dev/null || true)"
fi

parallel_says() { PARALLEL_HOME=$work/parallel bash "$work/$1.script" --jobs 2 --will-cite >"$work/$1.parallel.log" 2>&1; }
if has_parallel; then
    say "$(parallel --version | head -n 1)"
    write parallel short jobs 6
    parallel_says jobs || true
    same "GNU parallel, parts and their merge" jobs/all short
    write parallel sweep jobs-swept 3
    parallel_says jobs-swept || true
    same_sweep "GNU parallel, a sweep" jobs-swept/all sweep
    write parallel rule jobs-stop 4
    write parallel rules jobs-stops 4
    sed -i 's/--stop-after 60s/--stop-after 3s/' "$work/jobs-stop.script" "$work/jobs-stops.script"
    parallel_says jobs-stop || true
    same "GNU parallel, a stop over shards" jobs-stop/all rule
    spared jobs-stop
    parallel_says jobs-stops || true
    same_sweep "GNU parallel, a sweep whose points stop by their rule" jobs-stops/all rules
    write parallel long jobs-ended 3
    # All of the script's processes get the signal, as at Ctrl-C; it comes when some parts are under way.
    PARALLEL_HOME=$work/parallel setsid bash "$work/jobs-ended.script" --jobs 2 --will-cite >"$work/jobs-ended.parallel.log" 2>&1 &
    group=$!
    wait_for 60 test -e "$work/jobs-ended/part-2/state.bin" || true
    sleep 3
    kill -TERM -- "-$group"
    wait "$group" && { failed=$((failed + 1)); say "FAILED: the script ended well though it was stopped"; }
    [ ! -e "$work/jobs-ended/all" ] || { failed=$((failed + 1)); say "FAILED: it was merged though it was stopped"; }
    parallel_says jobs-ended || true
    same "GNU parallel, jobs that were stopped and go on" jobs-ended/all long
else
    did_not_run parallel "its package is missing"
fi

# Dask's workers need the Python package: the wheel that TAUTROPE names, or one that is built here.
python=
if python3 -m venv "$work/venv" 2>/dev/null && "$work/venv/bin/pip" install -q distributed maturin 2>/dev/null; then
    if [ -z "${TAUTROPE:-}" ]; then
        say "building the Python package"
        "$work/venv/bin/maturin" build --quiet --release --locked --interpreter "$work/venv/bin/python" \
            --features tautline/default --manifest-path python/Cargo.toml --out "$work/wheels"
        TAUTROPE=$(echo "$work"/wheels/*.whl)
    fi
    "$work/venv/bin/pip" install -q "$TAUTROPE" && python=$work/venv/bin/python
fi
if [ -n "$python" ]; then
    say "Dask $("$python" -c 'import distributed; print(distributed.__version__)')"
    port=26831
    "$python" -m distributed.cli.dask_scheduler --host 127.0.0.1 --port "$port" --no-dashboard >"$work/scheduler.daemon" 2>&1 &
    pids+=($!)
    for n in 1 2; do
        (cd "$work" && exec "$python" -m distributed.cli.dask_worker "tcp://127.0.0.1:$port" --host 127.0.0.1 --no-nanny \
            --no-dashboard --nthreads 2 --local-directory "$work" >"$work/worker$n.daemon" 2>&1) &
        pids+=($!)
        workers[n]=$!
    done
    write dask short tasks 4
    mkdir -p "$work/tasks" "$work/killed" "$work/enough" "$work/sweeps"
    "$python" "$work/tasks.script" "tcp://127.0.0.1:$port" >"$work/tasks/tasks.log" 2>&1 || true
    same "Dask, tasks and their merge" tasks short
    write dask sweep sweeps 4
    "$python" "$work/sweeps.script" "tcp://127.0.0.1:$port" >"$work/sweeps/tasks.log" 2>&1 || true
    same_sweep "Dask, a sweep" sweeps sweep
    write dask rule enough 8
    "$python" "$work/enough.script" "tcp://127.0.0.1:$port" >"$work/enough/tasks.log" 2>&1 || true
    same "Dask, a stop over shards" enough rule
    write dask rules ends 6
    mkdir -p "$work/ends"
    "$python" "$work/ends.script" "tcp://127.0.0.1:$port" >"$work/ends/tasks.log" 2>&1 || true
    same_sweep "Dask, a sweep whose points stop by their rule" ends rules
    write dask long killed 12
    "$python" "$work/killed.script" "tcp://127.0.0.1:$port" >"$work/killed/tasks.log" 2>&1 &
    client=$!
    wait_for 30 bash -c "ls '$work'/killed/parts/part-*" || true
    say "killing a worker"
    kill -9 "${workers[1]}"
    wait "$client" || true
    same "Dask, a worker that is killed" killed long
else
    did_not_run dask "it is neither installed nor to be had"
fi

for what in "${left_out[@]}"; do say "DID NOT RUN: $what"; done
say "$passed passed, $failed failed, ${#left_out[@]} schedulers left out"
[ "$failed" -eq 0 ]

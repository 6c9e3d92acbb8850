#!/usr/bin/env bash
# A SLURM of one node, this machine, with accounting; all its state in one folder.
#
#   one_node_slurm.sh up FOLDER      install Debian's packages where they are missing, start the daemons
#   one_node_slurm.sh down FOLDER    end the daemons that `up` started, and no other process
#
# Needs root on Debian or Ubuntu. Ports are its own (16817 to 16819, 13306). Outside FOLDER there is one link,
# /etc/slurm/slurm.conf, since job steps of the executor plugin look nowhere else; where a file of that name is
# there already, it stops.
set -euo pipefail
PACKAGES="slurm-wlm slurmdbd munge mariadb-server"
LINK=/etc/slurm/slurm.conf

say() { echo "slurm: $*"; }
fail() { echo "slurm: $*" >&2; exit 1; }

install_packages() {
  if command -v slurmctld slurmd slurmdbd munged mariadbd sacct > /dev/null; then return; fi
  command -v apt-get > /dev/null || fail "no apt-get here; install SLURM with slurmdbd, MUNGE and MariaDB yourself"
  say "installing Debian's $PACKAGES"
  apt-get update -qq > "$1/apt.log" 2>&1 || fail "apt-get update failed, see $1/apt.log"
  # No daemon is to be started by the packages themselves.
  policy=/usr/sbin/policy-rc.d
  if [ ! -e $policy ]; then printf '#!/bin/sh\nexit 101\n' > $policy; chmod +x $policy; made=1; fi
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $PACKAGES >> "$1/apt.log" 2>&1 \
    || fail "apt-get install failed, see $1/apt.log"
  if [ "${made:-}" ]; then rm $policy; fi
}

write_configuration() {
  local host cpus memory
  host=$(hostname -s); cpus=$(nproc); memory=$(awk '/^MemTotal/ {print int($2 / 1024 * 0.8)}' /proc/meminfo)
  cat > "$1/slurm.conf" <<CONF
ClusterName=local
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket=$1/munge/socket
CryptoType=crypto/munge
StateSaveLocation=$1/state
SlurmdSpoolDir=$1/spool
SlurmctldPidFile=$1/slurmctld.pid
SlurmdPidFile=$1/slurmd.pid
SlurmctldLogFile=$1/slurmctld.log
SlurmdLogFile=$1/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=2
JobAcctGatherParams=OverMemoryKill
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
ReturnToService=2
MpiDefault=none
SwitchType=switch/none
AccountingStorageType=accounting_storage/slurmdbd
AccountingStorageHost=127.0.0.1
AccountingStoragePort=16819
AccountingStoragePass=$1/munge/socket
AccountingStoreFlags=job_comment
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=$memory State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE DefMemPerCPU=1000 State=UP
CONF
  cat > "$1/slurmdbd.conf" <<CONF
AuthType=auth/munge
AuthInfo=socket=$1/munge/socket
DbdHost=localhost
DbdAddr=127.0.0.1
DbdPort=16819
SlurmUser=root
PidFile=$1/slurmdbd.pid
LogFile=$1/slurmdbd.log
StorageType=accounting_storage/mysql
StorageHost=127.0.0.1
StoragePort=13306
StorageLoc=slurm_acct_db
StorageUser=slurm
StoragePass=$2
CONF
  chmod 600 "$1/slurmdbd.conf"
}

# Wait until a command succeeds.
await() {
  for _ in $(seq 60); do if "$@" > /dev/null 2>&1; then return; fi; sleep 1; done
  fail "gave up after a minute: $*"
}

start_munge() {
  install -d -o munge -g munge -m 755 "$1/munge"
  dd if=/dev/urandom of="$1/munge/key" bs=1024 count=1 status=none
  chown munge: "$1/munge/key"; chmod 400 "$1/munge/key"
  runuser -u munge -- munged --key-file="$1/munge/key" --socket="$1/munge/socket" --pid-file="$1/munge/pid" \
    --log-file="$1/munge/log" --seed-file="$1/munge/seed"
  await munge --socket="$1/munge/socket" --no-input
}

start_database() {
  install -d -o mysql -g mysql "$1/database"
  mariadb-install-db --no-defaults --user=mysql --datadir="$1/database" --skip-test-db \
    --auth-root-authentication-method=normal > "$1/database.log" 2>&1
  mariadbd --no-defaults --user=mysql --datadir="$1/database" --socket="$1/database/socket" --port=13306 \
    --bind-address=127.0.0.1 --skip-name-resolve --pid-file="$1/database/pid" --innodb-lock-wait-timeout=900 \
    >> "$1/database.log" 2>&1 &
  local client="mariadb --no-defaults --socket=$1/database/socket --user=root"
  await $client --execute="SELECT 1"
  $client --execute="CREATE DATABASE slurm_acct_db; CREATE USER slurm@'127.0.0.1' IDENTIFIED BY '$2';
    GRANT ALL ON slurm_acct_db.* TO slurm@'127.0.0.1';"
}

start_slurm() {
  export SLURM_CONF="$1/slurm.conf"
  slurmdbd
  await sacctmgr --noheader list cluster
  sacctmgr -i add cluster local > "$1/accounts.log"
  sacctmgr -i add account lab cluster=local >> "$1/accounts.log"
  sacctmgr -i add user root account=lab >> "$1/accounts.log"
  slurmctld -f "$SLURM_CONF"
  slurmd -f "$SLURM_CONF" -N "$(hostname -s)"
  await sh -c 'sinfo --noheader --format=%T | grep -q idle'
}

up() {
  [ "$(id -u)" = 0 ] || fail "has to be run as root"
  [ ! -e $LINK ] && [ ! -L $LINK ] || fail "$LINK is there already: this machine has a SLURM of its own, or one was left running"
  mkdir -p "$1/state" "$1/spool"; chmod 755 "$1"
  install_packages "$1"
  local password; password=$(od -An -N16 -tx1 /dev/urandom | tr -d ' \n')
  write_configuration "$1" "$password"
  mkdir -p "$(dirname $LINK)"; ln -s "$1/slurm.conf" $LINK
  start_munge "$1"
  start_database "$1" "$password"
  start_slurm "$1"
  say "$(sinfo --version), one node with $(nproc) cores: $(sinfo --noheader --format='%N %T')"
}

down() {
  if [ "$(readlink $LINK)" = "$1/slurm.conf" ]; then
    scancel --user=root > /dev/null 2>&1 || true
    sleep 2
  fi
  for name in slurmd.pid slurmctld.pid slurmdbd.pid database/pid munge/pid; do
    if [ -s "$1/$name" ]; then
      local pid; pid=$(cat "$1/$name")
      kill "$pid" 2> /dev/null || continue
      for _ in $(seq 30); do kill -0 "$pid" 2> /dev/null || break; sleep 1; done
    fi
  done
  if [ "$(readlink $LINK)" = "$1/slurm.conf" ]; then rm $LINK; fi
  say "down"
}

[ $# = 2 ] && { [ "$1" = up ] || [ "$1" = down ]; } || fail "usage: $0 up|down FOLDER"
"$1" "$(realpath -m "$2")"

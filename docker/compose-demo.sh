#!/usr/bin/env bash
# The mission of compose.yaml to its end, its report, and its digest beside that of the same mission in one
# process. ONEHOP_SCENARIO: another mission, whose compose file is written first.
# Where the official base image cannot be pulled, a local one is made from this machine's Python.
set -euo pipefail
cd "$(dirname "$0")/.."

scenario=${ONEHOP_SCENARIO:-scenarios/map1.toml} file=compose.yaml
if [ "$scenario" != scenarios/map1.toml ]; then
  file=.compose-demo.yaml
  .venv/bin/onehop compose "$scenario" --out "$file"
fi
if docker compose version >/dev/null 2>&1; then compose=(docker compose); else compose=(docker-compose); fi
compose+=(--project-name onehop-demo --file "$file")

export ONEHOP_BASE=${ONEHOP_BASE:-python:3.11-slim}
if ! docker image inspect "$ONEHOP_BASE" >/dev/null 2>&1 && ! timeout 120 docker pull --quiet "$ONEHOP_BASE" 2>/dev/null; then
  echo "$ONEHOP_BASE cannot be pulled: making a base image from this machine's Python"
  ONEHOP_BASE=onehop-local-base
  .venv/bin/python docker/local_base.py "$ONEHOP_BASE"
fi

mkdir -p runs/compose
rm -rf runs/compose/mission.mcap runs/compose/summary.json runs/compose/report
export ONEHOP_UID=${ONEHOP_UID:-$(id -u)}
if [ "$ONEHOP_UID" = 0 ]; then  # nothing runs as root
  ONEHOP_UID=1000
  chown 1000:1000 runs/compose
fi
trap '"${compose[@]}" down --volumes --timeout 5 >/dev/null 2>&1; rm -f .compose-demo.yaml' EXIT
"${compose[@]}" build world
timeout 300 "${compose[@]}" --profile report up --no-build --no-color >runs/compose/containers.log 2>&1 || {
  tail -n 40 runs/compose/containers.log
  exit 1
}
.venv/bin/python docker/compare_digests.py runs/compose/summary.json "$scenario"

#!/bin/sh
for argument; do
    case "$argument" in --array=*) array="${argument#--array=}" ;; esac
    [ "$argument" = --wrap ] && wrap=next || { [ "$wrap" = next ] && wrap="$argument"; }
done
echo "$@" >>"$(dirname "$0")/asked"
for range in $(echo "$array" | tr , ' '); do
    for task in $(seq "${range%-*}" "${range#*-}"); do
        grep -qx "$task" "$(dirname "$0")/lost" || SLURM_ARRAY_TASK_ID="$task" sh -c "$wrap" >/dev/null
    done
done
echo "41;cluster"

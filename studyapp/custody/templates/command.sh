#!/bin/sh
# Run a command of Motion Jury on this study as the server's user, with the server's environment.
#
#     {{ study.unit }} researchers list     is    motionjury researchers FOLDER list
set -eu
if [ $# = 0 ]; then
    echo "Say which command, such as: {{ study.unit }} researchers list" >&2
    exit 2
fi
command=$1
shift
exec systemd-run --quiet --collect --wait --pipe --uid=motionjury --gid=motionjury \
    --property=EnvironmentFile=/etc/motionjury/{{ study.name }}.env \
    --property=UMask=0077 --working-directory=/srv/motionjury \
    {{ study.installed }}/bin/motionjury "$command" '{{ study.folder }}' "$@"

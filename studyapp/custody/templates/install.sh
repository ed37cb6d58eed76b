#!/bin/sh
# Install the files beside this script. Run it as root, once or again: a file that differs is
# kept beside the new one, with '.before' at the end of its name.
set -eu
cd "$(dirname "$0")"

install_file() { # name, place, mode
    if [ -e "$2" ] && cmp --silent "$1" "$2"; then
        return
    fi
    install -D --backup=simple --suffix=.before --owner=root --group=root --mode="$3" "$1" "$2"
    echo "$2"
}

{% for file in files if file.place %}
{% if file.keeps %}
[ -e {{ file.place }} ] || install_file {{ file.name }} {{ file.place }} {{ "%03o" | format(file.mode) }}
{% else %}
install_file {{ file.name }} {{ file.place }} {{ "%03o" | format(file.mode) }}
{% endif %}
{% endfor %}

# Only the study's server may read answers and keys.
folder='{{ study.folder }}'
chown --recursive motionjury:motionjury "$folder"
chmod --recursive u=rwX,g=,o= "$folder"
{% if study.proxy == "nginx" %}
# nginx may enter the folder and read the videos.
chgrp www-data "$folder"
chmod 710 "$folder"
chgrp --recursive www-data "$folder/videos"
chmod --recursive g=rX "$folder/videos"
{% endif %}

systemctl daemon-reload
systemctl restart systemd-journald

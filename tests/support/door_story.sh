# For scripts that play visits to a running daemon on a slow processor. Set story_directory (an empty directory for the socket of the bus,
# the gallery and the log) and story_source (the project), define a function `client` that runs isotherm with its arguments, and then run
# `. tests/support/door_story.sh`. Plain sh.
story_address=unix:path=$story_directory/bus

# A bus on which every user may make every call.
bus_conf() {
    cat <<END
<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig>
  <listen>$story_address</listen>
  <policy context="default">
    <allow send_destination="*"/>
    <allow receive_sender="*"/>
    <allow own="*"/>
  </policy>
</busconfig>
END
}

# Prints the sections of isotherm.conf that name the files of the daemon.
stores_conf() {
    cat <<END
[gallery]
path = $story_directory/gallery.db
[log]
path = $story_directory/audit.log
[bus]
address = $story_address
[model]
head = $story_source/core/data/head.model
metric = $story_source/core/data/face.metric
END
}

# A frame takes seconds on such a processor: few frames decide, the limits of time are long, and a camera that plays a recording again and
# again may show a frame twice. The thresholds of the scores are the usual ones.
patience_conf() {
    cat <<END
[decision]
agree = 2
max_frames = 2
gap_ms = 60000
refractory_ms = 1000
[motion]
frozen_frames = 0
[enroll]
stages = 2
timeout_ms = 600000
END
}

# The same for the section [sensor]: a slow processor must not make frames late or a camera silent.
patient_sensor_conf() {
    cat <<END
pause_ms = 600000
silence_ms = 600000
stale_ms = 600000
END
}

# Prints the log. It is sealed on the disk, so the daemon must read it.
log_records() {
    client log --count 100000 --json | tr -d ' \n'
}

has_logged() {
    log_records | grep -q "$1"
}

# count_logged RECORD: prints how many such records the log has
count_logged() {
    log_records | { grep -o "$1" || true; } | wc -l
}

# waits_for WHAT COMMAND...: until the command succeeds. After a minute it calls `die WHAT`, which the script defines.
waits_for() {
    what=$1 tries=300
    shift
    until "$@" >/dev/null 2>&1; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || die "$what"
        sleep 0.2
    done
}

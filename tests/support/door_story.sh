# For scripts that play visits to a running daemon on a slow processor: `. tests/support/door_story.sh`, after
# story_directory (an empty one: socket of the bus, gallery, log), story_source (the project) and a function `client` that runs
# isotherm with what it is given. Plain sh.
story_address=unix:path=$story_directory/bus

# A bus on which everybody may do everything.
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

# Where the daemon keeps what, for isotherm.conf.
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

# A frame takes seconds: few of them, patience, and no suspicion if a camera that plays a recording again and again shows the same one
# twice. The scores that decide are as they are.
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

# The same of the section [sensor]: frames are not too late, nor is the camera silent, because the processor is slow.
patient_sensor_conf() {
    cat <<END
pause_ms = 600000
silence_ms = 600000
stale_ms = 600000
END
}

# The log is sealed on the disk: the daemon has to read it.
log_records() {
    client log --count 100000 --json | tr -d ' \n'
}

has_logged() {
    log_records | grep -q "$1"
}

# count_logged RECORD: how many there are
count_logged() {
    log_records | { grep -o "$1" || true; } | wc -l
}

#!/bin/sh
# Makes visits of a corpus of single real frames, for `isotherm-sim levels`. All frames of one person, session and pose are one visit, in
# the manifest's order, 0.5 s apart, because the person moved between them. (At 33 ms, the appliance would take that for fast movements
# and leave the frames out.) But the person is enrolled with the frames of pose `frontal`, at rest (neutral, neutral2, eyes_closed),
# of all sessions but the last; the other frontal frames of these sessions are left out. OUT/all has everybody enrolled,
# with the other visits of everybody. OUT/without-PERSON has everybody but one person enrolled, with the visits of this person, who is
# a stranger there. The recordings link to the frames of CORPUS. No frame is copied.
# usage: real_visits.sh CORPUS OUT
set -eu
corpus=$(cd "$1" && pwd) out=$2
mkdir -p "$out/visits"
head='recording,first,count,subject,session,role,pose,expression,note'

# visit RECORDING NAME FRAME...: a recording of these frames, numbered from 0
visit() {
    from=$corpus/$1 to=$out/visits/$2
    shift 2
    mkdir -p "$to"
    cp "$from/recording.ini" "$to/recording.ini" # a reader takes no link for it
    for part in depth ir; do
        [ ! -e "$from/$part" ] || ln -sfn "$from/$part" "$to/$part"
    done
    for kind in depth ir; do
        [ -e "$from/$kind.txt" ] || continue
        echo "$@" | tr ' ' '\n' | awk -v list="$from/$kind.txt" '
            BEGIN { while ((getline line < list) > 0) { if (line !~ /^#/) { split(line, part, " "); file[n++] = part[2] } } }
            { printf "%.6f %s\n", (NR - 1) / 2, file[$1] }' >"$to/$kind.txt"
    done
}

# Lines: recording subject session pose, then the frames.
groups=$(awk -F, '
    NR == FNR { last = $5; next }
    FNR > 1 {
        session = $5
        if ($7 == "frontal" && $5 != last) {
            if ($8 !~ /^(neutral2?|eyes_closed)$/) { next }
            session = "enrol"
        }
        key = $1 " " $4 " " session " " $7
        if (!(key in frames)) { order[n++] = key }
        frames[key] = frames[key] " " $2
    }
    END { for (i = 0; i < n; i++) { print order[i] frames[order[i]] } }' "$corpus/manifest.csv" "$corpus/manifest.csv")
people=$(printf '%s\n' "$groups" | awk '!seen[$2]++ { print $2 }')

# corpus NAME: begins a corpus of links to the visits
begin() {
    mkdir -p "$out/$1"
    echo "$head" >"$out/$1/manifest.csv"
}

# add CORPUS VISIT FRAMES SUBJECT SESSION ROLE POSE
add() {
    ln -sfn "../visits/$2" "$out/$1/$2"
    echo "$2,0,$3,$4,$5,$6,$7,," >>"$out/$1/manifest.csv"
}

begin all
for person in $people; do
    begin "without-$person"
done
# Enrolments come first in every corpus, then the visits.
for role in gallery visit; do
    printf '%s\n' "$groups" | while read -r recording subject session pose frames; do
        name=$subject-$session-$pose
        enrols=visit
        [ "$session" != enrol ] || enrols=gallery
        count=$(echo "$frames" | wc -w)
        if [ "$role" = gallery ] && [ "$enrols" = gallery ]; then
            # shellcheck disable=SC2086
            visit "$recording" "$name" $frames
            add all "$name" "$count" "$subject" "$session" gallery "$pose"
            for person in $people; do
                [ "$person" = "$subject" ] || add "without-$person" "$name" "$count" "$subject" "$session" gallery "$pose"
            done
        elif [ "$role" = visit ] && [ "$enrols" = visit ]; then
            # shellcheck disable=SC2086
            visit "$recording" "$name" $frames
            add all "$name" "$count" "$subject" "$session" probe "$pose"
            add "without-$subject" "$name" "$count" "$subject" "$session" impostor "$pose"
        fi
    done
done

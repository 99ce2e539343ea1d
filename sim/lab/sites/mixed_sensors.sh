#!/bin/sh
# Measures a gallery whose people were enrolled before two sensors: shall all of them teach the metric, or only those of the sensor that
# sees the visitors? First half of the rendered people of preset strong are enrolled before one sensor and half before the other, which
# sees all of them. Then, if there is a corpus of real frames, its people are joined by rendered people before another sensor; the rates
# are those of the real people. SCRATCH keeps the corpora (sites-strong-SENSOR, as in promise.sh) and the reports (half-*, real-*). The
# environment may set PAIRS (FIRST:SEEING), SIZES, and OTHERS (SENSOR:NUMBER), each of them words, and ENROLLED, how many of the real
# people are enrolled; the others are strangers.
# usage: mixed_sensors.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY SCRATCH [REAL_CORPUS]
set -eu
sim=$1 ict=$2 data=$3 scratch=$4 real=${5:-}
here=$(dirname "$0")
export OPENBLAS_NUM_THREADS=1
mkdir -p "$scratch"
scratch=$(cd "$scratch" && pwd) # links need the whole path

# evaluate CORPUS SITE OUT OPTION...
evaluate() {
    corpus=$1 site=$2 out=$3
    shift 3
    "$sim" eval --corpus "$corpus" --fuse 1 --site "$site" --model "$data/head.model" --metric "$data/face.metric" --out "$out" "$@" \
        >"$out.txt"
}

# join_halves FIRST SEEING: people with an odd number are enrolled before the first sensor
join_halves() {
    corpus=$scratch/half-$1-$2/corpus
    rm -rf "$scratch/half-$1-$2"
    mkdir -p "$corpus"
    cp "$scratch/sites-strong-$2/manifest.csv" "$corpus/manifest.csv"
    awk -F , 'NR > 1 { print $1, $6, substr($4, 2) % 2 }' "$corpus/manifest.csv" | while read -r recording role odd; do
        from=$2
        [ "$role:$odd" != gallery:1 ] || from=$1
        ln -s "$scratch/sites-strong-$from/$recording" "$corpus/$recording"
    done
}

# print_halves REPORT: rank 1, EER, rates at 2 and 3, and mated comparisons below 3, as cells of a table
print_halves() {
    awk '/^  rank 1 / && !rank { rank = $3 }
         /^  EER / && !eer { eer = $2 " " $4 " " $5 }
         $1 == "3.0" && NF == 6 { lost = $6 }
         /^Promise:/ { promises = 1; next }
         /^  Cllr/ { promises = 0 }
         promises && $1 == 2 && NF == 5 { two = sprintf("%.2f [%.2f, %.2f]", $3, substr($4, 2), $5) }
         promises && $1 == 3 && NF == 5 { three = sprintf("%.3f [%.3f, %.3f]", $3, substr($4, 2), $5) }
         END { printf " %.1f | %s | %s | %s | %.1f |\n", rank, eer, two, three, lost }' "$1"
}

# join_real SENSOR NUMBER: the real corpus, and so many rendered people who are enrolled before a sensor
join_real() {
    corpus=$scratch/real-$1-$2/corpus
    rm -rf "$scratch/real-$1-$2"
    mkdir -p "$corpus"
    awk -F , -v most="${ENROLLED:-0}" '$6 == "gallery" && !at[$4] { at[$4] = ++n }
                                        $6 != "gallery" || !most || at[$4] <= most' "$real/manifest.csv" >"$corpus/manifest.csv"
    awk -F , 'NR > 1 && !seen[$1]++ { print $1 }' "$real/manifest.csv" | while read -r recording; do
        ln -s "$(cd "$real" && pwd)/$recording" "$corpus/$recording"
    done
    awk -F , '$6 == "gallery"' "$scratch/sites-strong-$1/manifest.csv" | head -n "$2" | while IFS= read -r row; do
        ln -s "$scratch/sites-strong-$1/${row%%,*}" "$corpus/${row%%,*}"
        echo "$row" >>"$corpus/manifest.csv"
    done
}

# print_real SCORES: the rates among the people of the real corpus, as cells of a table
print_real() {
    awk -F , 'NR == FNR { real[$4] = 1; next }
              $7 != "ok" || !real[$4] { next }
              $3 == $4 { mated++; low += $6 < 3; lower += $6 < 4; next }
              { others++; two += $6 >= 2; three += $6 >= 3; four += $6 >= 4 }
              END { printf " %.2f | %.2f | %.3f | %.1f | %.1f |\n", 100 * two / others, 100 * three / others, 100 * four / others,
                           100 * low / mated, 100 * lower / mated }' "$real/manifest.csv" "$1"
}

echo '| enrolled before | and before, seen by | people | learned from | rank 1, % | EER, % | reach 2, % | reach 3, % | mated lost at 3, % |'
echo '| --- | --- | --- | --- | --- | --- | --- | --- | --- |'
for pair in ${PAIRS-truedepth:kinect2-coarse truedepth:astra}; do
    first=${pair%:*} seeing=${pair#*:}
    for sensor in "$first" "$seeing"; do
        "$here/render.sh" "$sim" "$ict" strong "$sensor" "$scratch/sites-strong-$sensor"
    done
    join_halves "$first" "$seeing"
    for n in ${SIZES:-10 30 100}; do
        for site in none gallery sensor; do
            out=$scratch/half-$first-$seeing/$n-$site
            evaluate "$scratch/half-$first-$seeing/corpus" "$site" "$out" --gallery-limit "$n"
            # shellcheck disable=SC2016
            printf '| `%s` | `%s` | %s | `%s` |' "$first" "$seeing" "$n" "$site"
            print_halves "$out.txt"
        done
    done
done
[ -n "$real" ] || exit 0
echo
echo '| others, enrolled before | learned from | reach 2, % | reach 3, % | reach 4, % | mated lost at 3, % | at 4, % |'
echo '| --- | --- | --- | --- | --- | --- | --- |'
for other in ${OTHERS:-truedepth:7 truedepth:30 kinect2-coarse:7}; do
    sensor=${other%:*} n=${other#*:}
    "$here/render.sh" "$sim" "$ict" strong "$sensor" "$scratch/sites-strong-$sensor"
    join_real "$sensor" "$n"
    for site in none gallery sensor; do
        out=$scratch/real-$sensor-$n/$site
        evaluate "$scratch/real-$sensor-$n/corpus" "$site" "$out" --gallery-frames 2
        # shellcheck disable=SC2016
        printf '| %s, `%s` | `%s` |' "$n" "$sensor" "$site"
        print_real "$out/scores.csv"
    done
done

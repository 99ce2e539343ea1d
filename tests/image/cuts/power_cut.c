/* Makes the disk of a machine as a power cut leaves it, from a log of all its writes.
 *
 * points LOG PARTITIONS COUNT SEED: prints random points (cut_points.h).
 *
 * stages LOG: prints the number of entries of each kind between the marks.
 *
 * apply LOG IMAGE FROM TO: writes the entries [FROM, TO) into the image.
 *
 * cut LOG IMAGE FLUSHED POINT SEED: writes a random part of the entries [FLUSHED, POINT), which
 * were not flushed.
 *
 * spoil unflushed|late LOG OUT PARTITIONS PARTITION BEGIN END: copies the log with a mistake
 * between the marks BEGIN and END.
 *
 * In every cut, one in four loses all entries that were not flushed, one in four has all of them
 * and only the last is torn, and in the others each is there or not with equal chances, and one in
 * four is torn. Of a torn entry a random number of sectors from its beginning is there, or each
 * sector or not.
 *
 * The mistakes: `unflushed` leaves out the flushes, as if nobody had waited for the disk. `late`
 * lets the writes to the partition come only directly before END, as if the boot entry had been
 * written first. */
#include "tests/image/cuts/cut_points.h"

#include <endian.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static uint64_t parse(const char *text)
{
    char *end;
    uint64_t value = strtoull(text, &end, 10);
    if (*text < '0' || *text > '9' || *end != '\0') {
        give_up("%s is no number", text);
    }
    return value;
}

/* The end of a range of entries: a number, or the word "all". */
static size_t parse_end(const struct write_log *log, const char *text)
{
    uint64_t end = strcmp(text, "all") == 0 ? log->count : parse(text);
    if (end > log->count) {
        give_up("the log has only %zu entries", log->count);
    }
    return (size_t)end;
}

static int open_image(const char *path, int flags)
{
    int image = open(path, flags | O_CLOEXEC, 0644);
    if (image < 0) {
        give_up("%s cannot be opened", path);
    }
    return image;
}

static void tear(const struct write_log *log, const struct write_entry *entry, int image,
                 uint64_t *state)
{
    if (random_below(state, 2) == 0) {
        write_log_apply(log, entry, 0, random_below(state, entry->sectors + 1), image);
        return;
    }
    for (uint64_t i = 0; i < entry->sectors; i++) {
        if (random_below(state, 2) == 0) {
            write_log_apply(log, entry, i, 1, image);
        }
    }
}

static void cut(const struct write_log *log, int image, size_t flushed, size_t point, uint64_t seed)
{
    uint64_t state = seed, kind = random_below(&state, 4);
    for (size_t i = flushed; i < point; i++) {
        const struct write_entry *entry = &log->entries[i];
        bool chosen = random_below(&state, 2) == 0, torn = random_below(&state, 4) == 0;
        if (kind == 0) {
            chosen = false;
        } else if (kind == 1) {
            chosen = true;
            torn = i + 1 == point;
        }
        if (entry->kept || (chosen && !torn)) {
            write_log_apply(log, entry, 0, entry->sectors, image);
        } else if (chosen) {
            tear(log, entry, image, &state);
        }
    }
}

static void print_stages(const struct write_log *log)
{
    const char *name = "(before)";
    size_t writes = 0, flushes = 0, discards = 0;
    uint64_t sectors = 0;
    for (size_t i = 0; i < log->count; i++) {
        const struct write_entry *entry = &log->entries[i];
        flushes += entry->flush ? 1 : 0;
        discards += entry->discard ? 1 : 0;
        writes += entry->sectors > 0 && !entry->discard ? 1 : 0;
        sectors += entry->discard ? 0 : entry->sectors;
        if (entry->mark[0] != '\0' || i + 1 == log->count) {
            printf("%s: %zu writes with %" PRIu64 " kB, %zu flushes, %zu discards\n", name, writes,
                   sectors / 2, flushes, discards);
            name = entry->mark;
            writes = flushes = discards = 0;
            sectors = 0;
        }
    }
}

/* ---- logs with a mistake ---- */

struct copy {
    int file;
    uint64_t place;
    uint64_t count;
};

static void put(struct copy *copy, const void *bytes, size_t size)
{
    if (pwrite(copy->file, bytes, size, (off_t)copy->place) != (ssize_t)size) {
        give_up("the copy of the log cannot be written");
    }
    copy->place += size;
}

static void put_entry(struct copy *copy, const struct write_log *log,
                      const struct write_entry *entry)
{
    unsigned char head[SECTOR];
    if (pread(log->file, head, SECTOR, (off_t)(entry->data - SECTOR)) != SECTOR) {
        give_up("the log cannot be read");
    }
    put(copy, head, SECTOR);
    struct write_entry moved = *entry;
    moved.sector = copy->place / SECTOR;
    write_log_apply(log, &moved, 0, entry->sectors, copy->file);
    copy->place += entry->discard ? 0 : entry->sectors * SECTOR;
    copy->count++;
}

static void put_late(struct copy *copy, const struct write_log *log, struct partition late,
                     size_t begin, size_t end)
{
    for (size_t i = begin; i <= end; i++) {
        if (entry_is_in(&log->entries[i], late)) {
            put_entry(copy, log, &log->entries[i]);
        }
    }
}

static void spoil(const struct write_log *log, const char *kind, const char *out,
                  struct partition late, size_t begin, size_t end)
{
    struct copy copy = {.file = open_image(out, O_RDWR | O_CREAT | O_TRUNC), .place = SECTOR};
    bool is_late = strcmp(kind, "late") == 0;
    if ((!is_late && strcmp(kind, "unflushed") != 0) || late.size == 0 || begin >= end) {
        give_up("no such mistake");
    }
    for (size_t i = 0; i < log->count; i++) {
        const struct write_entry *entry = &log->entries[i];
        bool within = i >= begin && i <= end;
        if (i == end && is_late) {
            put_late(&copy, log, late, begin, end);
        }
        if (!(within && (is_late ? entry_is_in(entry, late) : entry->flush))) {
            put_entry(&copy, log, entry);
        }
    }
    unsigned char head[SECTOR];
    uint64_t count = htole64(copy.count);
    if (pread(log->file, head, SECTOR, 0) != SECTOR) {
        give_up("the log cannot be read");
    }
    memcpy(head + 16, &count, sizeof(count));
    copy.place = 0;
    put(&copy, head, SECTOR);
    close(copy.file);
}

static bool run(int count, char **words, struct write_log *log)
{
    const char *command = count > 2 ? words[1] : "";
    if (strcmp(command, "spoil") == 0 && count == 9) {
        write_log_open(log, words[3]);
        spoil(log, words[2], words[4], partition_find(words[5], words[6]), mark_find(log, words[7]),
              mark_find(log, words[8]));
        return true;
    }
    if (count > 2) {
        write_log_open(log, words[2]);
    }
    if (strcmp(command, "points") == 0 && count == 6) {
        cut_points_print(log, words[3], (size_t)parse(words[4]), parse(words[5]));
    } else if (strcmp(command, "stages") == 0 && count == 3) {
        print_stages(log);
    } else if (strcmp(command, "apply") == 0 && count == 6) {
        int image = open_image(words[3], O_WRONLY);
        size_t end = parse_end(log, words[5]);
        for (size_t i = (size_t)parse(words[4]); i < end; i++) {
            write_log_apply(log, &log->entries[i], 0, log->entries[i].sectors, image);
        }
        close(image);
    } else if (strcmp(command, "cut") == 0 && count == 7) {
        int image = open_image(words[3], O_WRONLY);
        cut(log, image, (size_t)parse(words[4]), parse_end(log, words[5]), parse(words[6]));
        close(image);
    } else {
        return false;
    }
    return true;
}

int main(int count, char **words)
{
    struct write_log log = {.file = -1};
    if (!run(count, words, &log)) {
        give_up("the words of the command are wrong; see power_cut.c");
    }
    write_log_close(&log);
    return fflush(stdout) == 0 ? 0 : 1;
}

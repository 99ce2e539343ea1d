#include "tests/image/cuts/write_log.h"

#include <endian.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* From the kernel's drivers/md/dm-log-writes.c: the numbers of its format. */
static const uint64_t magic = 0x6a736677736872ULL;
enum { VERSION = 1, FLUSH = 1, FUA = 2, DISCARD = 4 };

void give_up(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("power_cut: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    exit(1);
}

static void read_sector(int file, uint64_t place, unsigned char sector[SECTOR])
{
    ssize_t got = pread(file, sector, SECTOR, (off_t)place);
    if (got != SECTOR) {
        give_up("the log ends at byte %llu, within an entry", (unsigned long long)place);
    }
}

static uint64_t number(const unsigned char *bytes)
{
    uint64_t value;
    memcpy(&value, bytes, sizeof(value));
    return le64toh(value);
}

static void read_mark(const struct write_log *log, struct write_entry *entry)
{
    unsigned char sector[SECTOR];
    if (entry->flush || entry->discard || entry->sectors != 1) {
        return;
    }
    read_sector(log->file, entry->data, sector);
    size_t length = sizeof(MARK_TEXT) - 1;
    if (memcmp(sector, MARK_TEXT " ", length + 1) != 0) {
        return;
    }
    size_t n = 0;
    const unsigned char *name = sector + length + 1;
    while (n + 1 < sizeof(entry->mark) && name[n] > ' ' && name[n] <= '~') {
        entry->mark[n] = (char)name[n];
        n++;
    }
    entry->mark[n] = '\0';
}

static uint64_t read_entry(const struct write_log *log, struct write_entry *entry, uint64_t place)
{
    unsigned char head[SECTOR];
    read_sector(log->file, place, head);
    uint64_t flags = number(head + 16);
    *entry = (struct write_entry){
        .sector = number(head),
        .sectors = number(head + 8),
        .data = place + SECTOR,
        .flush = (flags & FLUSH) != 0,
        .kept = (flags & FUA) != 0,
        .discard = (flags & DISCARD) != 0,
    };
    if (flags > (FLUSH | FUA | DISCARD) || entry->sectors > UINT64_MAX / SECTOR / 2 ||
        (entry->flush && entry->sectors != 0)) {
        give_up("byte %llu of the log is no entry", (unsigned long long)place);
    }
    read_mark(log, entry);
    return entry->data + (entry->discard ? 0 : entry->sectors * SECTOR);
}

void write_log_open(struct write_log *log, const char *path)
{
    unsigned char head[SECTOR];
    uint32_t size;
    log->file = open(path, O_RDONLY | O_CLOEXEC);
    if (log->file < 0) {
        give_up("%s: %s", path, strerror(errno));
    }
    read_sector(log->file, 0, head);
    memcpy(&size, head + 24, sizeof(size));
    if (number(head) != magic || number(head + 8) != VERSION || le32toh(size) != SECTOR) {
        give_up("%s is no log of writes with sectors of %d bytes", path, SECTOR);
    }
    uint64_t end = (uint64_t)lseek(log->file, 0, SEEK_END), place = SECTOR;
    log->count = (size_t)number(head + 16);
    if (log->count == 0 || log->count > end / SECTOR) {
        give_up("%s cannot have %zu entries", path, log->count);
    }
    log->entries = calloc(log->count, sizeof(*log->entries));
    if (log->entries == NULL) {
        give_up("no memory");
    }
    for (size_t i = 0; i < log->count; i++) {
        place = read_entry(log, &log->entries[i], place);
    }
    if (place > end) {
        give_up("%s: the last entry is not complete", path);
    }
}

void write_log_close(struct write_log *log)
{
    close(log->file);
    free(log->entries);
}

void write_log_apply(const struct write_log *log, const struct write_entry *entry, uint64_t first,
                     uint64_t count, int image)
{
    static unsigned char piece[1 << 20];
    uint64_t from = entry->data + first * SECTOR, to = (entry->sector + first) * SECTOR;
    uint64_t rest = entry->discard ? 0 : count * SECTOR;
    while (rest > 0) {
        size_t size = rest < sizeof(piece) ? (size_t)rest : sizeof(piece);
        if (pread(log->file, piece, size, (off_t)from) != (ssize_t)size) {
            give_up("the log cannot be read at byte %llu", (unsigned long long)from);
        }
        if (pwrite(image, piece, size, (off_t)to) != (ssize_t)size) {
            give_up("the image cannot be written at byte %llu", (unsigned long long)to);
        }
        from += size;
        to += size;
        rest -= size;
    }
}

size_t write_log_flushed(const struct write_log *log, size_t point)
{
    size_t n = point < log->count ? point : log->count;
    while (n > 0 && !log->entries[n - 1].flush) {
        n--;
    }
    return n;
}

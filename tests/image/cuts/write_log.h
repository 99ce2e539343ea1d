/* The log of all writes to a disk that QEMU's driver `blklogwrites` keeps, in the format of the
 * kernel's dm-log-writes (Documentation/admin-guide/device-mapper/log-writes.rst): a header, then
 * one entry for each write, flush and discard in the order in which they were completed, each
 * followed by its data. All places and sizes are in sectors of 512 bytes. */
#ifndef TESTS_IMAGE_CUTS_WRITE_LOG_H
#define TESTS_IMAGE_CUTS_WRITE_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SECTOR = 512 };

/* The script of the test in the machine writes this, a blank, a name and a line end into a sector
 * that no partition has, so that the log says what the machine was doing. */
#define MARK_TEXT "isotherm-mark"

struct write_entry {
    uint64_t sector;  /* of the disk */
    uint64_t sectors; /* 0 for a flush */
    uint64_t data;    /* byte of the log at which the data begin */
    bool flush;       /* all entries before this one are on the disk */
    bool kept;        /* is on the disk as soon as it is completed (FUA) */
    bool discard;     /* has no data */
    char mark[32];    /* the name of a mark; empty for all other entries */
};

struct write_log {
    int file;
    size_t count;
    struct write_entry *entries;
};

/* Reads the entries of a log. Says in one line what is wrong and ends the program if this is no
 * such log, or if it is not complete. */
void write_log_open(struct write_log *log, const char *path);

void write_log_close(struct write_log *log);

/* Writes the sectors [first, first + count) of the data of an entry into an image of the disk. Ends
 * the program on an error. */
void write_log_apply(const struct write_log *log, const struct write_entry *entry, uint64_t first,
                     uint64_t count, int image);

/* The number of entries before the last flush at or before entry `point`: these are on the disk,
 * whatever happens. */
size_t write_log_flushed(const struct write_log *log, size_t point);

/* Prints a line with the name of the program and ends it with 1. */
_Noreturn void give_up(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif

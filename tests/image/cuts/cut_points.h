/* The stages of an update in the log of a machine's writes, and random points in them. */
#ifndef TESTS_IMAGE_CUTS_CUT_POINTS_H
#define TESTS_IMAGE_CUTS_CUT_POINTS_H

#include "tests/image/cuts/write_log.h"

/* A random generator whose state is its seed: splitmix64 (Steele, Lea, Flood, 2014). */
uint64_t random_next(uint64_t *state);

/* A random number below `end`, which is not 0. */
uint64_t random_below(uint64_t *state, uint64_t end);

/* A range of sectors of the disk; `size` is 0 if there is no partition of this name. */
struct partition {
    uint64_t start;
    uint64_t size;
};

/* Finds a partition in a file with one line "NAME START SIZE" for each. Ends the program on an
 * error. */
struct partition partition_find(const char *path, const char *name);

bool entry_is_in(const struct write_entry *entry, struct partition partition);

/* The entry with this mark. Ends the program if there is none. */
size_t mark_find(const struct write_log *log, const char *name);

/* Prints `count` points in order, one line "POINT FLUSHED SEED STAGE" for each: the power is cut
 * after POINT entries, FLUSHED of them are on the disk for certain, and SEED decides about the
 * others.
 *
 * Each mark begins a stage, which the next one ends; the mark `end` ends the last. A stage
 * `install-X` is divided further: before the first write to the partitions root-X and root-X-verity
 * (before), until the last one (slot), until the next write to the EFI system partition (between),
 * and the rest (entry). In every stage, points directly before and behind writes to the EFI system
 * partition are a further stage (NAME.esp). Each stage has the same number of points, give or take
 * one: most writes are in few stages. */
void cut_points_print(const struct write_log *log, const char *partitions, size_t count,
                      uint64_t seed);

#endif

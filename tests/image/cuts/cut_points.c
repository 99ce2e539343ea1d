#include "tests/image/cuts/cut_points.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STAGES = 64 };

struct stage {
    char name[48];
    size_t begin; /* points [begin, end) */
    size_t end;
    bool at_esp; /* only those at writes to the EFI system partition */
};

struct stages {
    size_t count;
    struct stage at[STAGES];
    struct partition esp;
    const struct write_log *log;
};

struct cut_point {
    size_t point;
    uint64_t seed;
    const char *stage;
};

uint64_t random_next(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15ULL;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
    return z ^ z >> 31;
}

uint64_t random_below(uint64_t *state, uint64_t end)
{
    return random_next(state) % end; /* `end` is tiny against 2^64 */
}

struct partition partition_find(const char *path, const char *name)
{
    struct partition found = {0, 0}, here;
    char line[256], label[64];
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        give_up("%s cannot be read", path);
    }
    while (fgets(line, sizeof(line), file) != NULL) {
        if (sscanf(line, "%63s %" SCNu64 " %" SCNu64, label, &here.start, &here.size) != 3) {
            give_up("%s: not NAME START SIZE: %s", path, line);
        }
        if (strcmp(label, name) == 0) {
            found = here;
        }
    }
    fclose(file);
    return found;
}

bool entry_is_in(const struct write_entry *entry, struct partition partition)
{
    return entry->sectors > 0 && entry->sector < partition.start + partition.size &&
           entry->sector + entry->sectors > partition.start;
}

size_t mark_find(const struct write_log *log, const char *name)
{
    for (size_t i = 0; i < log->count; i++) {
        if (strcmp(log->entries[i].mark, name) == 0) {
            return i;
        }
    }
    give_up("the log has no mark %s", name);
}

/* A point p is at a write to the EFI system partition if that is the last entry before the cut, or
 * the first one behind it. */
static bool is_at_esp(const struct stages *stages, size_t point)
{
    const struct write_log *log = stages->log;
    return (point > 0 && entry_is_in(&log->entries[point - 1], stages->esp)) ||
           (point < log->count && entry_is_in(&log->entries[point], stages->esp));
}

static void add_stage(struct stages *stages, const char *name, const char *part, size_t begin,
                      size_t end)
{
    if (begin >= end) {
        return;
    }
    bool has_esp = false;
    for (size_t p = begin; p < end; p++) {
        has_esp = has_esp || is_at_esp(stages, p);
    }
    for (int at_esp = 0; at_esp <= (has_esp ? 1 : 0); at_esp++) {
        if (stages->count == STAGES) {
            give_up("more than %d stages", STAGES);
        }
        struct stage *stage = &stages->at[stages->count++];
        *stage = (struct stage){.begin = begin, .end = end, .at_esp = at_esp == 1};
        snprintf(stage->name, sizeof(stage->name), "%s%s%s", name, part, at_esp ? ".esp" : "");
    }
}

/* The stages of the installation into slot `slot`, between two marks. */
static void add_install(struct stages *stages, const char *partitions, const char *name,
                        const char *slot, size_t begin, size_t end)
{
    char label[64];
    snprintf(label, sizeof(label), "root-%s", slot);
    struct partition root = partition_find(partitions, label);
    snprintf(label, sizeof(label), "root-%s-verity", slot);
    struct partition tree = partition_find(partitions, label);
    size_t first = end, last = end, entry = end;
    for (size_t i = begin; i < end; i++) {
        if (entry_is_in(&stages->log->entries[i], root) ||
            entry_is_in(&stages->log->entries[i], tree)) {
            first = first == end ? i : first;
            last = i;
        }
    }
    if (first == end) {
        give_up("%s: no write to slot %s", name, slot);
    }
    for (size_t i = end; i-- > last;) {
        entry = entry_is_in(&stages->log->entries[i], stages->esp) ? i : entry;
    }
    add_stage(stages, name, ".before", begin, first + 1);
    add_stage(stages, name, ".slot", first + 1, last + 1);
    add_stage(stages, name, ".between", last + 1, entry + 1);
    add_stage(stages, name, ".entry", entry + 1, end);
}

static void find_stages(struct stages *stages, const char *partitions)
{
    const struct write_log *log = stages->log;
    size_t begin = 0, last = mark_find(log, "end");
    const char *name = NULL;
    for (size_t i = 0; i <= last; i++) {
        const char *mark = log->entries[i].mark;
        if (mark[0] == '\0') {
            continue;
        }
        if (name != NULL && strncmp(name, "install-", 8) == 0) {
            add_install(stages, partitions, name, name + 8, begin, i + 1);
        } else if (name != NULL) {
            add_stage(stages, name, "", begin, i + 1);
        }
        name = mark;
        begin = i + 1;
    }
}

static size_t choose(const struct stages *stages, const struct stage *stage, uint64_t *state)
{
    size_t candidates = 0, point = stage->begin;
    for (size_t p = stage->begin; p < stage->end; p++) {
        candidates += !stage->at_esp || is_at_esp(stages, p) ? 1 : 0;
    }
    size_t skip = (size_t)random_below(state, candidates);
    for (size_t p = stage->begin; p < stage->end; p++) {
        if (stage->at_esp && !is_at_esp(stages, p)) {
            continue;
        }
        if (skip-- == 0) {
            point = p;
            break;
        }
    }
    return point;
}

static int compare(const void *left, const void *right)
{
    const struct cut_point *a = left, *b = right;
    return a->point < b->point ? -1 : a->point > b->point;
}

void cut_points_print(const struct write_log *log, const char *partitions, size_t count,
                      uint64_t seed)
{
    static struct stages stages;
    stages = (struct stages){.esp = partition_find(partitions, "esp"), .log = log};
    find_stages(&stages, partitions);
    if (stages.count == 0 || count == 0) {
        give_up("no points in %zu stages", stages.count);
    }
    struct cut_point *points = calloc(count, sizeof(*points));
    if (points == NULL) {
        give_up("no memory");
    }
    for (size_t i = 0; i < count; i++) {
        const struct stage *stage = &stages.at[i % stages.count];
        points[i] = (struct cut_point){choose(&stages, stage, &seed), random_next(&seed) >> 16,
                                       stage->name};
    }
    qsort(points, count, sizeof(*points), compare);
    for (size_t i = 0; i < count; i++) {
        printf("%zu %zu %" PRIu64 " %s\n", points[i].point, write_log_flushed(log, points[i].point),
               points[i].seed, points[i].stage);
    }
    free(points);
}

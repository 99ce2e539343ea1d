#include "sim/corpus/import.h"

#include <errno.h>
#include <fts.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/recording/recording_writer.h"
#include "sim/base/make_directory.h"
#include "sim/base/progress.h"

enum { PNG_LEVEL = 4 };

struct scan {
    char *path;
    const char *file; /* the last part of the path */
    bool neutral;
    struct sim_corpus_row row;
};

struct scans {
    size_t n, capacity;
    struct scan *items;
};

static void scans_done(struct scans *scans)
{
    for (size_t i = 0; i < scans->n; i++) {
        free(scans->items[i].path);
    }
    free(scans->items);
}

static int add_scan(struct scans *scans, const char *path, const struct scan *found)
{
    if (scans->n == scans->capacity) {
        const size_t capacity = 2 * scans->capacity + 256;
        struct scan *items = realloc(scans->items, capacity * sizeof *items);
        if (!items) {
            return -ENOMEM;
        }
        scans->items = items;
        scans->capacity = capacity;
    }
    struct scan *scan = &scans->items[scans->n];
    *scan = *found;
    scan->path = strdup(path);
    if (!scan->path) {
        return -ENOMEM;
    }
    scan->file = strrchr(scan->path, '/');
    scan->file = scan->file ? scan->file + 1 : scan->path;
    scans->n++;
    return 0;
}

/* Names the recording: the file's name without its last extension. False if the name is too long.
 */
static bool name_recording(const char *file, char name[SIM_CORPUS_NAME_MAX])
{
    const char *dot = strrchr(file, '.');
    const int length = dot ? (int)(dot - file) : (int)strlen(file);
    return snprintf(name, SIM_CORPUS_NAME_MAX, "%.*s", length, file) < SIM_CORPUS_NAME_MAX;
}

static int find_scans(const struct sim_import_options *o, struct scans *scans,
                      struct iso_fault *fault)
{
    char *directory = strdup(o->from);
    char *const paths[] = {directory, NULL};
    FTS *tree = directory ? fts_open(paths, FTS_PHYSICAL | FTS_NOCHDIR, NULL) : NULL;
    FTSENT *entry;
    int error = tree ? 0 : -errno;
    while (!error && (entry = fts_read(tree))) {
        struct scan scan = {.row = {.count = 1}};
        if (entry->fts_info == FTS_DNR || entry->fts_info == FTS_ERR || entry->fts_info == FTS_NS) {
            error = -entry->fts_errno;
        } else if (entry->fts_info == FTS_F &&
                   o->database->describe(entry->fts_name, &scan.row, &scan.neutral) &&
                   name_recording(entry->fts_name, scan.row.recording)) {
            error = add_scan(scans, entry->fts_path, &scan);
        }
    }
    if (tree) {
        (void)fts_close(tree);
    }
    free(directory);
    return error ? iso_fault_set(fault, error, "%s: %s", o->from, strerror(-error)) : 0;
}

static int by_person_and_file(const void *a, const void *b)
{
    const struct scan *x = a, *y = b;
    const int order = strcmp(x->row.subject, y->row.subject);
    return order ? order : strcmp(x->file, y->file);
}

static int check_names(const struct scans *scans, struct iso_fault *fault)
{
    for (size_t i = 1; i < scans->n; i++) {
        if (strcmp(scans->items[i].row.recording, scans->items[i - 1].row.recording) == 0) {
            return iso_fault_set(fault, -EINVAL, "%s and %s: the same name", scans->items[i].path,
                                 scans->items[i - 1].path);
        }
    }
    return 0;
}

static int write_recording(const struct sim_import_options *o, const struct scan *scan,
                           const struct iso_frame *frame, struct iso_fault *fault)
{
    char path[PATH_MAX];
    struct iso_recording_meta meta = {.unit_mm = o->database->unit_mm};
    struct sim_recording_writer *writer = NULL;
    meta.camera = sim_recording_camera(frame);
    (void)snprintf(meta.sensor, sizeof meta.sensor, "%s", o->database->name);
    int error = iso_path_join(o->to, scan->row.recording, path, fault);
    if (!error) {
        error = sim_recording_writer_create(path, &meta, PNG_LEVEL, &writer, fault);
    }
    if (!error) {
        error = sim_recording_writer_append(writer, frame, fault);
    }
    if (!error) {
        error = sim_recording_writer_finish(writer, fault);
    }
    sim_recording_writer_free(writer);
    return error;
}

/* Records the scans that can be read and moves the others to the end of the list. */
static int record_scans(const struct sim_import_options *o, struct scans *scans,
                        struct sim_import_report *report, struct iso_fault *fault)
{
    size_t kept = 0;
    int error = 0;
    const bool shown = sim_progress_begin("reading scans", scans->n);
    for (size_t i = 0; i < scans->n && !error; i++) {
        struct scan *scan = &scans->items[i];
        sim_progress_step(1);
        struct iso_frame *frame = NULL;
        struct iso_fault damage = {.text = ""};
        if (o->database->read(scan->path, &o->database_options, &frame, &damage)) {
            sim_progress_pause();
            fprintf(stderr, "isotherm-sim: scan left out: %s\n", damage.text);
            sim_progress_resume();
            report->refused++;
            continue;
        }
        error = write_recording(o, scan, frame, fault);
        iso_frame_free(frame);
        struct scan swap = scans->items[kept];
        scans->items[kept++] = *scan;
        *scan = swap;
    }
    sim_progress_end(shown);
    report->scans = kept;
    return error || kept > 0 ? error
                             : iso_fault_set(fault, -ENOENT, "%s: no scan of %s can be read",
                                             o->from, o->database->name);
}

/* Sets the roles in the rows of one person's n scans. */
static void give_roles(struct scan *scans, size_t n, bool stranger)
{
    size_t enrolled = 0;
    while (enrolled < n && !scans[enrolled].neutral) {
        enrolled++;
    }
    enrolled = enrolled < n ? enrolled : 0;
    for (size_t i = 0; i < n; i++) {
        scans[i].row.role = i == enrolled ? SIM_ROLE_GALLERY : SIM_ROLE_PROBE;
        if (stranger) {
            scans[i].row.role = SIM_ROLE_IMPOSTOR;
        }
    }
}

static size_t person_ends(const struct scan *scans, size_t n, size_t first)
{
    size_t end = first + 1;
    while (end < n && strcmp(scans[end].row.subject, scans[first].row.subject) == 0) {
        end++;
    }
    return end;
}

static int write_manifest(const struct sim_import_options *o, struct scan *scans, size_t n,
                          struct sim_import_report *report, struct iso_fault *fault)
{
    struct sim_corpus_row *rows = calloc(n, sizeof *rows);
    if (!rows) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", o->to);
    }
    for (size_t first = 0; first < n; first = person_ends(scans, n, first)) {
        report->people++;
    }
    size_t person = 0;
    for (size_t first = 0; first < n; person++) {
        const size_t end = person_ends(scans, n, first);
        give_roles(&scans[first], end - first, person + o->n_strangers >= report->people);
        first = end;
    }
    for (size_t i = 0; i < n; i++) {
        rows[i] = scans[i].row;
    }
    const int error = report->people > o->n_strangers
                          ? sim_corpus_write(o->to, rows, n, fault)
                          : iso_fault_set(fault, -EINVAL, "%s: %zu people, none left to enrol",
                                          o->from, report->people);
    free(rows);
    return error;
}

int sim_import(const struct sim_import_options *options, struct sim_import_report *report,
               struct iso_fault *fault)
{
    struct scans scans = {0};
    struct sim_import_report counted = {0};
    int error = find_scans(options, &scans, fault);
    if (!error && scans.n == 0) {
        error = iso_fault_set(fault, -ENOENT, "%s: no file has a name of the database %s",
                              options->from, options->database->name);
    }
    if (!error) {
        qsort(scans.items, scans.n, sizeof *scans.items, by_person_and_file);
        error = check_names(&scans, fault);
    }
    if (!error) {
        error = sim_make_directory(options->to, fault);
    }
    if (!error) {
        error = record_scans(options, &scans, &counted, fault);
    }
    if (!error) {
        error = write_manifest(options, scans.items, counted.scans, &counted, fault);
    }
    if (!error) {
        *report = counted;
    }
    scans_done(&scans);
    return error;
}

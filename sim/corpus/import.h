/* A public database becomes a corpus: a recording of one frame for each scan, and a manifest.
 *
 * Of each person the first neutral scan by file name is enrolled (the first of all if none is), the
 * others are probes; the last n_strangers people are not enrolled and are impostors. File names are
 * those of the database, wherever below the directory the files lie. */
#ifndef SIM_CORPUS_IMPORT_H
#define SIM_CORPUS_IMPORT_H

#include <stddef.h>

#include "sim/corpus/database.h"

struct sim_import_options {
    const struct sim_database *database;
    const char *from, *to; /* directories; `to` is made if it is missing */
    size_t n_strangers;    /* people, the last by name */
    struct sim_database_options database_options;
};

struct sim_import_report {
    size_t scans, people, refused; /* refused: damaged files, complained about on stderr */
};

/* -ENOENT if no scan is found or none can be read, -EINVAL for two scans of one file name or fewer
 * people than strangers, or the errors of reading the directory and of writing; each with a fault.
 */
int sim_import(const struct sim_import_options *options, struct sim_import_report *report,
               struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

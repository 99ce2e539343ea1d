/* Converts a public database into a corpus: a recording of one frame for each scan, and a manifest.
 *
 * Each person is enrolled with the first neutral scan by file name (the first scan if none is
 * neutral); the other scans are probes. The last n_strangers people are not enrolled and are
 * impostors. Files are recognised by the database's file names, in any folder below the
 * directory. */
#ifndef SIM_CORPUS_IMPORT_H
#define SIM_CORPUS_IMPORT_H

#include <stddef.h>

#include "sim/corpus/database.h"

struct sim_import_options {
    const struct sim_database *database;
    const char *from, *to; /* directories; `to` is created if it is missing */
    size_t n_strangers;    /* people, the last by name */
    struct sim_database_options database_options;
};

struct sim_import_report {
    size_t scans, people, refused; /* refused: unreadable files, each reported on stderr */
};

/* Imports all scans and writes the manifest. -ENOENT if no scan is found or none can be read;
 * -EINVAL for two scans with the same file name, or if n_strangers leaves no person to enrol; or
 * the errors of reading the directory and of writing. Each comes with a fault. */
int sim_import(const struct sim_import_options *options, struct sim_import_report *report,
               struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

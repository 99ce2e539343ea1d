/* Public databases of 3D faces: the naming scheme and the reader of their files.
 *
 * None of them may be redistributed. Owners of a licence can import their copy
 * (sim/corpus/import.h). */
#ifndef SIM_CORPUS_DATABASE_H
#define SIM_CORPUS_DATABASE_H

#include <stdbool.h>

#include "isotherm/frame.h"
#include "sim/corpus/corpus.h"

struct sim_database_options {
    double level_mm; /* depth of one grey level of a range image */
};

struct sim_database {
    const char *name;
    const char *source; /* its authors and its content */
    double unit_mm;     /* of a depth count in recordings made from it */

    /* Derives subject, session, pose, expression and note of the row from a file's name.
     * *neutral: the person is at rest and looks ahead, or the name has no information about it.
     * Returns false for a name that is not a scan's. */
    bool (*describe)(const char *file, struct sim_corpus_row *row, bool *neutral);

    /* Reads a scan into a new frame. -EBADMSG, -EFBIG, -ENOMEM or the errno of open and read, each
     * with a fault. */
    int (*read)(const char *path, const struct sim_database_options *options,
                struct iso_frame **out, struct iso_fault *fault);
};

extern const struct sim_database sim_database_texas, sim_database_frgc, sim_database_bosphorus,
    sim_database_bu3dfe, sim_database_gavab, sim_database_casia;

/* All databases; NULL ends the list. */
extern const struct sim_database *const sim_databases[];

/* The database with this name, or NULL. */
const struct sim_database *sim_database_find(const char *name);

#endif

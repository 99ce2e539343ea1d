/* Public databases of 3D faces: how their files are named, and read.
 *
 * None of them may be passed on; those who have a licence can import it (sim/corpus/import.h). */
#ifndef SIM_CORPUS_DATABASE_H
#define SIM_CORPUS_DATABASE_H

#include <stdbool.h>

#include "isotherm/frame.h"
#include "sim/corpus/corpus.h"

struct sim_database_options {
    double level_mm; /* what a grey level of a range image is worth */
};

struct sim_database {
    const char *name;
    const char *source; /* who made it, and what it holds */
    double unit_mm;     /* of a depth count in recordings made from it */

    /* What a file's name says: subject, session, pose, expression and note of the row. *neutral:
     * the person is at rest and looks ahead, or the name does not say. False for names that are not
     * of scans. */
    bool (*describe)(const char *file, struct sim_corpus_row *row, bool *neutral);

    /* Reads a scan into a new frame. -EBADMSG, -EFBIG, -ENOMEM or the errno of open and read, each
     * with a fault. */
    int (*read)(const char *path, const struct sim_database_options *options,
                struct iso_frame **out, struct iso_fault *fault);
};

extern const struct sim_database sim_database_texas, sim_database_frgc, sim_database_bosphorus,
    sim_database_bu3dfe, sim_database_gavab, sim_database_casia;

/* All of them, ended by NULL. */
extern const struct sim_database *const sim_databases[];

/* By name, or NULL. */
const struct sim_database *sim_database_find(const char *name);

#endif

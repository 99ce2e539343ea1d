/* A corpus: a directory of recordings and manifest.csv, which says who is in which frames.
 *
 *   recording,first,count,subject,session,role,pose,expression,note
 *
 * The header line is fixed. Fields hold no commas, quotes or control characters. `first` and
 * `count` are the frames of the recording that the row means (count > 1: frames to fuse). A row
 * repeats another if recording, first, count and role are the same. Every failure is one line
 * "file:line: what is wrong" in *fault (which may be NULL). */
#ifndef SIM_CORPUS_CORPUS_H
#define SIM_CORPUS_CORPUS_H

#include <stdbool.h>
#include <stddef.h>

#include "core/base/fault.h"

enum { SIM_CORPUS_NAME_MAX = 64 };

enum sim_role {
    SIM_ROLE_GALLERY,
    SIM_ROLE_PROBE,
    SIM_ROLE_IMPOSTOR, /* a person who is in no gallery, or nobody: subject `none` */
    SIM_ROLES
};

/* "gallery", "probe", "impostor"; NULL outside the range. */
const char *sim_role_name(enum sim_role role);

struct sim_corpus_row {
    char recording[SIM_CORPUS_NAME_MAX]; /* a directory of the corpus: no '/', does not start with
                                            '.' */
    size_t first, count;                 /* count >= 1 */
    char subject[SIM_CORPUS_NAME_MAX];   /* required */
    char session[SIM_CORPUS_NAME_MAX];   /* this and the other words may be empty */
    enum sim_role role;
    char pose[SIM_CORPUS_NAME_MAX];
    char expression[SIM_CORPUS_NAME_MAX];
    char note[SIM_CORPUS_NAME_MAX]; /* of people: sim_corpus_row_is_of */
};

struct sim_corpus {
    size_t n_rows;
    struct sim_corpus_row *rows; /* in the file's order */
};

/* Parses the text of a manifest, without looking at recordings; `name` stands for the file in
 * faults. -EBADMSG for another header, a wrong number of fields, a bad field, a repeated row, an
 * impostor who is in the gallery, no rows; -ENOMEM. */
int sim_corpus_parse(const char *name, const char *text, struct sim_corpus **out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Reads DIRECTORY/manifest.csv and opens every recording it names to see that the frames are there.
 * Errors of sim_corpus_parse and iso_recording_open, -ENOENT for a missing manifest; a missing or
 * unreadable recording and a range beyond its end are -EBADMSG of the row that names it. */
int sim_corpus_read(const char *directory, struct sim_corpus **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes DIRECTORY/manifest.csv, replacing it in one step. -EINVAL for rows that would not be read
 * back, or the errno of writing. */
int sim_corpus_write(const char *directory, const struct sim_corpus_row *rows, size_t n_rows,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Rendered corpora say who is in a row by the first word of its note, the origin "POPULATION-SEED";
 * words that follow it say more of the row ("test-31 enrolled-behind"). Returns the length of that
 * word, or 0 if there is none. */
size_t sim_corpus_origin_length(const char *note);

/* Whether the row has the same origin as another note, which may be the origin alone. False for an
 * empty note. */
bool sim_corpus_row_is_of(const struct sim_corpus_row *row, const char *note);

void sim_corpus_free(struct sim_corpus *corpus);

#endif

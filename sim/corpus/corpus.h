/* A corpus: a directory of recordings with manifest.csv, which names the person in each range of
 * frames.
 *
 *   recording,first,count,subject,session,role,pose,expression,note
 *
 * The header line is fixed. Fields hold no commas, double quotes or control characters. `first` and
 * `count` select the frames of the recording for this row (count > 1: frames to fuse). A row
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
    SIM_ROLE_IMPOSTOR, /* a person who is not enrolled, or subject `none`: not a person */
    SIM_ROLES
};

/* "gallery", "probe", "impostor"; NULL outside the range. */
const char *sim_role_name(enum sim_role role);

struct sim_corpus_row {
    /* A directory of the corpus: no '/', no '.' at the start. */
    char recording[SIM_CORPUS_NAME_MAX];
    size_t first, count;               /* count >= 1 */
    char subject[SIM_CORPUS_NAME_MAX]; /* required */
    char session[SIM_CORPUS_NAME_MAX]; /* this and the following words may be empty */
    enum sim_role role;
    char pose[SIM_CORPUS_NAME_MAX];
    char expression[SIM_CORPUS_NAME_MAX];
    char note[SIM_CORPUS_NAME_MAX]; /* for people see sim_corpus_row_is_of */
};

struct sim_corpus {
    size_t n_rows;
    struct sim_corpus_row *rows; /* in the order of the file */
};

/* Parses the text of a manifest without opening recordings; `name` stands for the file in
 * faults. -EBADMSG for another header, a wrong number of fields, an invalid field, a repeated
 * row, an impostor who is in the gallery, or no rows; -ENOMEM. */
int sim_corpus_parse(const char *name, const char *text, struct sim_corpus **out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Reads DIRECTORY/manifest.csv and opens every named recording to check that the frames exist.
 * Errors of sim_corpus_parse and of reading the manifest; -ENOENT if there is no manifest. A
 * missing or unreadable recording, or a range beyond its end, is -EBADMSG for the row that names
 * it. */
int sim_corpus_read(const char *directory, struct sim_corpus **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes DIRECTORY/manifest.csv and replaces an old one in one step. -EINVAL for rows that the
 * reader would refuse, or the errno of writing. */
int sim_corpus_write(const char *directory, const struct sim_corpus_row *rows, size_t n_rows,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* In rendered corpora the first word of a row's note is the origin of the person,
 * "POPULATION-SEED"; further words describe the row ("test-31 enrolled-behind"). Returns the
 * length of the first word, or 0 if there is none. */
size_t sim_corpus_origin_length(const char *note);

/* Whether the row has the same origin as another note, which may consist of the origin alone.
 * False for an empty note. */
bool sim_corpus_row_is_of(const struct sim_corpus_row *row, const char *note);

/* Frees it and what it holds. NULL is accepted. */
void sim_corpus_free(struct sim_corpus *corpus);

#endif

/* The gallery's database: tables, seals, transactions, and failures of SQLite in words for people.
 * Internal to the gallery (gallery.h), which keeps the same contents in memory.
 *
 *   head      one row: gallery (its random id), key (number in the key ring), record (sealed)
 *   person    id, record (sealed: dates and name)
 *   template  id, person_id -> person, algorithm, record (sealed: iso_template_serialise)
 *   access    id, person_id (0: the site), part (0, 1, ...), record (sealed: a part of the access
 *             record, because a record is at most as long as a template). The table exists since
 *             the first access record
 *   vector    id -> template, record (sealed: the vector of the template by the metric). The table
 *             exists since the first start that stored vectors. It only saves time: a vector that
 *             is missing or does not open is made again
 *
 * gallery_seal.h says how records are sealed. PATH.anchor contains the number of changes
 * (anchor.h), and the gallery's id. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_DB_H
#define ISO_FIRMWARE_GALLERY_GALLERY_DB_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/gallery/gallery.h"
#include "isotherm/metric.h"

struct iso_gallery_db;
struct iso_gallery_place;

/* As iso_gallery_open: makes the database if there is none, seals one of version 1, checks it, and
 * locks it until it is closed. */
int iso_gallery_db_open(const struct iso_gallery_options *options, struct iso_gallery_db **out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Closes, wipes and frees it. NULL is accepted. */
void iso_gallery_db_close(struct iso_gallery_db *db);

/* The vector of one template. Biometric. */
struct iso_gallery_vector {
    int64_t number;                       /* of the template */
    bool learned;                         /* the template was learned at a visit */
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* that made the template */
    struct iso_metric_vector vector;      /* by the metric of the gallery's options */
};

/* Receives the contents. Functions return 0, or a negative errno with *fault set. */
struct iso_gallery_visitor {
    /* The counts of the person are 0. */
    int (*person)(void *context, const struct iso_person *person, struct iso_fault *fault);
    int (*template)(void *context, const struct iso_gallery_place *place, const void *bytes,
                    size_t size, struct iso_fault *fault);
    /* A part of an access record; place->algorithm is its number. */
    int (*access)(void *context, const struct iso_gallery_place *place, const void *bytes,
                  size_t size, struct iso_fault *fault);
    /* If it is not NULL: called instead of `template` for a usable template whose vector is stored.
     * The template is what it was when the vector was made, and is not opened. */
    int (*vector)(void *context, const struct iso_gallery_place *place,
                  const struct iso_gallery_vector *stored, struct iso_fault *fault);
    void *context;
};

/* Passes first all people by rising id, then all templates by rising person and id, then all parts
 * of access records by rising person and part. Checks that no record is missing, also within a
 * transaction, and that each stored vector belongs to a template. Whether a template and an access
 * record belong to somebody has to be checked by a visitor that loads a gallery: the file is not
 * asked for that. -EBADMSG for a gallery that is damaged, and the errors of the visitor. */
int iso_gallery_db_load(struct iso_gallery_db *db, const struct iso_gallery_visitor *visitor,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Passes the templates of one person by rising id; the visitor's `person` is not called. The
 * caller, who knows their number, has to check that none is missing. */
int iso_gallery_db_templates(struct iso_gallery_db *db, int64_t person,
                             const struct iso_gallery_visitor *visitor, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- changes: iso_gallery_db_begin, then some of the others, then iso_gallery_db_end ---- */

/* Begins a change. -EIO: the anchor of the change before still cannot be written, or the database
 * is out of service. */
int iso_gallery_db_begin(struct iso_gallery_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Commits the changes since begin, all or none; with `error` (negative, from one of them) none.
 * Returns that error, or its own. After 0 the changes are on the disk, and after an error they are
 * not: if the disk reports an error, its contents are read again. The exception is that they cannot
 * be read: then the error is -EIO, and the database is out of service. */
int iso_gallery_db_end(struct iso_gallery_db *db, int error, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* person->id 0: adds a person; otherwise changes that person to the given values. *id is the
 * person's. */
int iso_gallery_db_put_person(struct iso_gallery_db *db, const struct iso_person *person,
                              int64_t *id, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Adds a template (iso_template_serialise) to a person. *number is that of the template. */
int iso_gallery_db_put_template(struct iso_gallery_db *db, int64_t person_id, uint32_t algorithm,
                                const void *bytes, size_t size, int64_t *number,
                                struct iso_fault *fault) __attribute__((warn_unused_result));

/* Stores the access record of a person, or of the site (0), in place of the earlier one; size 0
 * only deletes that. */
int iso_gallery_db_put_access(struct iso_gallery_db *db, int64_t person_id, const void *bytes,
                              size_t size, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Deletes a person with all templates and the access record. */
int iso_gallery_db_drop_person(struct iso_gallery_db *db, int64_t id, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The record of the templates that teach; the caller may change it between begin and end. */
struct iso_site_record *iso_gallery_db_site(struct iso_gallery_db *db);

/* Marks that an enrolment begins with the next template, if the metric adapts. */
void iso_gallery_db_mark(struct iso_gallery_db *db);

/* The number after the last one that was used. */
uint64_t iso_gallery_db_next(const struct iso_gallery_db *db);

/* Stores the vectors of n templates, in a transaction of its own, which is no change of the
 * gallery: its number of changes stays. If the disk refuses, the vectors are not stored, and
 * nothing else happens; but if the disk cannot be read either, the database is out of service. */
void iso_gallery_db_store_vectors(struct iso_gallery_db *db,
                                  const struct iso_gallery_vector *vectors, size_t n);

/* ---- out of service ---- */

/* Returns 0 if the database is in service, else -EIO with the reason. It is out of service if its
 * contents after a change are not known, because the disk cannot be read. Then every call that can
 * fail, except iso_gallery_db_recover, returns -EIO. */
int iso_gallery_db_state(const struct iso_gallery_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Tries to bring it into service again. After 0 the caller has to load everything again. -EIO. */
int iso_gallery_db_recover(struct iso_gallery_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Takes it out of service, because the caller could not load it. Returns -EIO with *fault set. */
int iso_gallery_db_give_up(struct iso_gallery_db *db, const struct iso_fault *why,
                           struct iso_fault *fault);

/* ---- other functions ---- */

/* Seals everything with a new key, in one transaction, and drops the old key. The listener counts
 * records. */
int iso_gallery_db_rotate(struct iso_gallery_db *db, const struct iso_work_listener *listener,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes the anchor again, with the newest key of its kind. */
int iso_gallery_db_renew_anchor(struct iso_gallery_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* As iso_gallery_version. */
struct iso_gallery_version iso_gallery_db_version(const struct iso_gallery_db *db);

/* "PATH: damaged (WHAT); ...": the fault of a database that cannot be trusted. Returns -EBADMSG. */
int iso_gallery_db_damaged(const struct iso_gallery_db *db, const char *what,
                           struct iso_fault *fault);

#endif

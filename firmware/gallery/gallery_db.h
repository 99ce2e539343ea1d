/* The gallery's database: tables, seals, transactions, and what each failure of SQLite means to a
 * person. Internal to the gallery (gallery.h), which holds the same in memory.
 *
 *   head      one row: gallery (its random id), key (number in the key ring), record (sealed)
 *   person    id, record (sealed: dates and name)
 *   template  id, person_id -> person, algorithm, record (sealed: iso_template_serialise)
 *
 * gallery_seal.h says how records are sealed. PATH.anchor holds the number of changes (anchor.h),
 * and the gallery's id. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_DB_H
#define ISO_FIRMWARE_GALLERY_GALLERY_DB_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/gallery/gallery.h"

struct iso_gallery_db;

/* As iso_gallery_open: makes the database if there is none, seals one of version 1, checks it, and
 * keeps others out until it is closed. */
int iso_gallery_db_open(const struct iso_gallery_options *options, struct iso_gallery_db **out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));
void iso_gallery_db_close(struct iso_gallery_db *db);

/* What is told of the contents. Functions return 0, or a negative errno with *fault set. */
struct iso_gallery_visitor {
    /* Counts are 0. */
    int (*person)(void *context, const struct iso_person *person, struct iso_fault *fault);
    int (*template)(void *context, int64_t person_id, uint32_t algorithm, const void *bytes,
                    size_t size, struct iso_fault *fault);
    void *context;
};

/* First all people by rising id, then all templates by rising person and id. Checks that they are
 * all the records there should be, also within a transaction. */
int iso_gallery_db_load(struct iso_gallery_db *db, const struct iso_gallery_visitor *visitor,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* The templates of one person alone, by rising id; the visitor's `person` is not called. That none
 * is missing is for the caller to see, who knows how many there are. */
int iso_gallery_db_templates(struct iso_gallery_db *db, int64_t person,
                             const struct iso_gallery_visitor *visitor, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- changes: begin, some of the others, end ---- */

/* -EIO: the change before could not be anchored, and still cannot; or the database is out of
 * service. */
int iso_gallery_db_begin(struct iso_gallery_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Makes the changes since begin hold, all or none; with `error` (negative, of one of them) none.
 * Returns that error, or its own. 0 is returned only when the changes are on the disk, and an error
 * only when they are not: if the disk reports an error, its contents are read again. If they cannot
 * be read, the error is -EIO and the database is out of service. */
int iso_gallery_db_end(struct iso_gallery_db *db, int error, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* person->id 0: a new person, else that one as it is now. *id is the person's. */
int iso_gallery_db_put_person(struct iso_gallery_db *db, const struct iso_person *person,
                              int64_t *id, struct iso_fault *fault)
    __attribute__((warn_unused_result));

int iso_gallery_db_put_template(struct iso_gallery_db *db, int64_t person_id, uint32_t algorithm,
                                const void *bytes, size_t size, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Deletes a person with all templates. */
int iso_gallery_db_drop_person(struct iso_gallery_db *db, int64_t id, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- out of service ---- */

/* What the disk holds after a change is not known, because the disk refuses to be read: every call
 * but these and close returns -EIO. 0: it is in service. */
int iso_gallery_db_state(const struct iso_gallery_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Tries to bring it into service again: 0, and the caller has to load everything anew. -EIO. */
int iso_gallery_db_recover(struct iso_gallery_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Takes it out of service, because the caller could not load it: -EIO with *fault set. */
int iso_gallery_db_give_up(struct iso_gallery_db *db, const struct iso_fault *why,
                           struct iso_fault *fault);

/* ---- the rest ---- */

/* Seals everything with a new key, in one transaction, and drops the old one. The listener is told
 * of records. */
int iso_gallery_db_rotate(struct iso_gallery_db *db, const struct iso_work_listener *listener,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes the anchor anew, with the newest key of its kind. */
int iso_gallery_db_renew_anchor(struct iso_gallery_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

struct iso_gallery_version iso_gallery_db_version(const struct iso_gallery_db *db);

/* "PATH: damaged (WHAT); ...": what is said when the database cannot be trusted; -EBADMSG. */
int iso_gallery_db_damaged(const struct iso_gallery_db *db, const char *what,
                           struct iso_fault *fault);

#endif

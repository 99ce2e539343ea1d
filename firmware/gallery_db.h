/* The gallery's database: tables, transactions, and what each failure of SQLite means to a person.
 * Internal to the gallery (gallery.h), which holds the same in memory.
 *
 *   person    id, name (unique), enrolled_s, valid_from_s, valid_until_s
 *   template  id, person_id -> person, algorithm, bytes (iso_template_serialise) */
#ifndef ISO_FIRMWARE_GALLERY_DB_H
#define ISO_FIRMWARE_GALLERY_DB_H

#include <stddef.h>
#include <stdint.h>

#include "core/fault.h"
#include "firmware/gallery.h"

struct iso_gallery_db;

/* As iso_gallery_open: makes the database if there is none, checks it whole, and keeps others out
 * until it is closed. */
int iso_gallery_db_open(const char *path, struct iso_gallery_db **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void iso_gallery_db_close(struct iso_gallery_db *db);

/* What is told of the contents. Functions return 0, or a negative errno with *fault set. */
struct iso_gallery_visitor {
    /* Counts are 0. */
    int (*person)(void *context, const struct iso_person *person, struct iso_fault *fault);
    int (*template)(void *context, int64_t person_id, uint32_t algorithm, const void *bytes,
                    size_t size, struct iso_fault *fault);
    void *context;
};

/* First all people by rising id, then all templates by rising person and id. */
int iso_gallery_db_load(struct iso_gallery_db *db, const struct iso_gallery_visitor *visitor,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Adds a template, in one transaction. person->id 0: makes the person, else sets the limits of that
 * one. *id is the person's. */
int iso_gallery_db_add(struct iso_gallery_db *db, const struct iso_person *person,
                       uint32_t algorithm, const void *bytes, size_t size, int64_t *id,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Deletes a person with all templates, in one transaction. */
int iso_gallery_db_remove(struct iso_gallery_db *db, int64_t id, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* "PATH: damaged (WHAT); ...": what is said when the database cannot be trusted; -EBADMSG. */
int iso_gallery_db_damaged(const struct iso_gallery_db *db, const char *what,
                           struct iso_fault *fault);

#endif

/* The gallery: who is enrolled, with which templates; in an SQLite database, and all of it in
 * memory for the search.
 *
 * Every change is one transaction that is on the disk when the call returns: after a kill at any
 * moment the gallery is what it was before the change or after it. A new database is made beside
 * its place and moved there when it is whole. A damaged one is never repaired or replaced: to
 * open it is -EBADMSG, and the fault says what to do. Templates of another algorithm (or template
 * version) are kept and counted, and take no part in searches. One process at a time has the
 * database. What is deleted is overwritten.
 *
 * Used by one thread. Everything handed out is valid until the next add, remove or close. Templates
 * are wiped from memory when they are freed. */
#ifndef ISO_FIRMWARE_GALLERY_H
#define ISO_FIRMWARE_GALLERY_H

#include <stddef.h>
#include <stdint.h>

#include "core/fault.h"
#include "core/match/search.h"
#include "core/match/template.h"
#include "firmware/person_name.h"

enum {
    ISO_GALLERY_APPLICATION_ID = 0x49534f54, /* "ISOT" */
    ISO_GALLERY_SCHEMA = 1,
    ISO_GALLERY_TEMPLATES_MAX = 16, /* of one person */
};

struct iso_person {
    int64_t id; /* never used for anybody else */
    char name[ISO_PERSON_NAME_SIZE];
    int64_t enrolled_s, valid_from_s, valid_until_s; /* since 1970; limits: 0 is none */
    uint32_t templates, usable;                      /* usable: those of the running algorithm */
};

struct iso_gallery;

/* Opens the database, or makes an empty one. capacity: most people. algorithm: whose templates are
 * searched. Errors, each with a line that says what to do:
 *   -EBADMSG     damaged, empty or cut short
 *   -EMEDIUMTYPE a database of another application, or no database
 *   -EPROTONOSUPPORT written by a newer version
 *   -EBUSY       another process has it
 *   -EROFS       it cannot be written; -EACCES, -ENOENT (no such directory)
 *   -ENOSPC      the disk is full; -EIO, -ENOMEM */
int iso_gallery_open(const char *path, int capacity, uint32_t algorithm, struct iso_gallery **out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));
void iso_gallery_close(struct iso_gallery *gallery);

/* Adds a template to the person of this name, who is made if need be; an existing person keeps the
 * date of enrolment and takes the new limits. person's id and counts are ignored. The template is
 * copied. -EINVAL the name or the template is bad, -EDQUOT the gallery, or this person, is full,
 * -ENOSPC, -EIO, -EROFS, -ENOMEM; then nothing has changed. */
int iso_gallery_add(struct iso_gallery *gallery, const struct iso_person *person,
                    const struct iso_template *tmpl, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Deletes a person with all templates. -ENOENT nobody has this name, else as add. */
int iso_gallery_remove(struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* 0 if a template can be added for this name, else -EDQUOT with a fault. */
int iso_gallery_room(const struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Everybody, in the order of enrolment. */
const struct iso_person *iso_gallery_people(const struct iso_gallery *gallery, size_t *n);

/* NULL if there is no such person. */
const struct iso_person *iso_gallery_find(const struct iso_gallery *gallery, const char *name);
const struct iso_person *iso_gallery_find_id(const struct iso_gallery *gallery, int64_t id);

/* The usable templates, those of one person side by side. */
const struct iso_search_entry *iso_gallery_entries(const struct iso_gallery *gallery, int *n);

/* The usable templates of one person; NULL and 0 if there are none. */
const struct iso_search_entry *iso_gallery_entries_of(const struct iso_gallery *gallery,
                                                      int64_t person, int *n);

#endif

/* The gallery: the enrolled people and their templates, sealed in an SQLite database. The people,
 * and the data for a search, are also in memory: with a metric an index of vectors
 * (isotherm/index.h, 632 bytes a person), else the templates.
 *
 * Every change is one transaction that is on the disk when the call returns: after a kill at any
 * moment the gallery is what it was before the change or after it. A new database is made beside
 * its place and moved there when it is whole. A damaged database is never repaired or replaced:
 * opening it returns -EBADMSG, and the fault says what to do. Templates of another algorithm (or
 * template version) are kept and counted, and take no part in searches. One process at a time has
 * the database. Deleted data is overwritten. Copies of it that a journal or a flash memory still
 * holds are sealed, and the next rotation of keys makes them unreadable for ever.
 *
 * Without the key ring, a reader of the database learns how many people there are and how many
 * templates of which algorithm each has, and nothing else. A record that was changed, lies in the
 * place of another, is missing, or is of an earlier time is detected when the database is opened
 * (-EBADMSG). A whole database of an earlier time is detected, too (-ESTALE), as far as anchor.h
 * says.
 *
 * With a metric, a start that has to make many vectors stores them beside the templates
 * (gallery_db.h), because this takes most of the time of a start. They are sealed, are deleted with
 * their templates, and are no change of the gallery. What is damaged is found with them as without
 * them.
 *
 * A name belongs to one person only, whatever its spelling (person_name.h), and every spelling
 * finds that person; the gallery keeps the spelling of the first enrolment. An old gallery may
 * have two people whose names differ in case only. They stay two: each is found by the exact name;
 * any other spelling finds the one who was enrolled first.
 *
 * After an error of the disk, the gallery reads from the disk what came of the change before it
 * returns, so that memory, result and file always agree (gallery_truth.c).
 *
 * Used by one thread. Everything handed out is valid until the next add, import, remove, recover,
 * forget_learned, follow_site or close. Templates and vectors are wiped from memory when
 * they are freed. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_H
#define ISO_FIRMWARE_GALLERY_GALLERY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/person_name.h"
#include "firmware/contract/validity.h"
#include "firmware/contract/work_listener.h"
#include "firmware/gallery/candidate_list.h"
#include "firmware/keys/key_ring.h"
#include "firmware/site/site_index.h"
#include "isotherm/template.h"

enum {
    ISO_GALLERY_APPLICATION_ID = 0x49534f54, /* the characters "ISOT" */
    ISO_GALLERY_SCHEMA_SEALED = 2,           /* the first version that is sealed */
    ISO_GALLERY_SCHEMA_SITE = 3,             /* records which templates are excluded */
    ISO_GALLERY_SCHEMA = 4,                  /* the newest version; it has access records */
    ISO_GALLERY_TEMPLATES_MAX = ISO_CONTRACT_TEMPLATES_MAX, /* of one person */
    ISO_GALLERY_ACCESS_MAX = 2 << 20,                       /* bytes of an access record */
};

struct iso_person {
    int64_t id; /* a number that no other person ever gets */
    char name[ISO_PERSON_NAME_SIZE];
    struct iso_person_name_key key;                  /* key of the name; set by the gallery */
    int64_t enrolled_s, valid_from_s, valid_until_s; /* since 1970; limits: 0 means none */
    uint32_t templates, usable; /* usable: templates of the running algorithm */
};

/* Whether the door opens to the person at now_s. Somebody without limits is valid at any time;
 * somebody with a limit is not valid while the time is not known. */
static inline bool iso_person_is_valid(const struct iso_person *person, bool time_known,
                                       int64_t now_s)
{
    return (person->valid_from_s == 0 && person->valid_until_s == 0) ||
           (time_known && now_s >= person->valid_from_s &&
            (person->valid_until_s == 0 || now_s <= person->valid_until_s));
}

struct iso_gallery;

struct iso_gallery_options {
    const char *path;                /* the anchor is at PATH.anchor */
    int capacity;                    /* largest number of people */
    uint32_t algorithm;              /* the algorithm whose templates are searched */
    const struct iso_metric *metric; /* outlives the gallery; NULL: templates stay in memory */
    bool adapt; /* with a metric: it adapts to the people of the gallery (site/site_index.h) */
    struct iso_key_ring *ring; /* outlives the gallery */
    bool migrate; /* seal a database of version 1, which was not sealed, at the first start */
};

/* Opens the database, or makes an empty one. Errors, each with a line that says what to do:
 *   -EBADMSG     damaged, empty, cut short, or with exchanged records
 *   -ESTALE      older than its anchor, without an anchor, missing, or no longer sealed
 *   -EKEYREJECTED the key ring does not have its key
 *   -EMEDIUMTYPE a database of another application, or not a database
 *   -EPROTONOSUPPORT written by a newer version
 *   -EBUSY       another process has it
 *   -EROFS       it cannot be written; -EACCES, -ENOENT (no such directory)
 *   -ENOSPC      the disk is full
 * Other errors are -EIO and -ENOMEM. */
int iso_gallery_open(const struct iso_gallery_options *options, struct iso_gallery **out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Closes it and frees it. NULL is accepted. */
void iso_gallery_close(struct iso_gallery *gallery);

/* Adds a template to the person of this name. A new person is added; an existing person keeps the
 * date of enrolment and the spelling of the name, and gets the limits of `person`: to keep the
 * limits, the caller passes the stored ones. person's id, key and counts are ignored. The template
 * is copied. -EINVAL the name or the template is bad, -EDQUOT the gallery, or this person, is
 * full, -ENOSPC, -EIO, -EROFS, -ENOMEM; then nothing has changed, or the gallery is out of service
 * (iso_gallery_state). */
int iso_gallery_add(struct iso_gallery *gallery, const struct iso_person *person,
                    const struct iso_template *tmpl, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Adds n templates (1..ISO_GALLERY_TEMPLATES_MAX) of one person in the same way, all of them or
 * none, in one transaction. Errors of iso_gallery_add. */
int iso_gallery_add_all(struct iso_gallery *gallery, const struct iso_person *person,
                        const struct iso_template *const *templates, int n, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Deletes a person with all templates. -ENOENT nobody has this name, else as add. */
int iso_gallery_remove(struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Gives a person another name; templates, dates and number stay. -ENOENT nobody has this name,
 * -EINVAL the new name is bad, -EEXIST another person has it, else as add. The first function only
 * checks whether the second one would refuse. */
int iso_gallery_may_rename(const struct iso_gallery *gallery, const char *name,
                           const char *new_name, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_gallery_rename(struct iso_gallery *gallery, const char *name, const char *new_name,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Changes from when and until when the door opens to a person. -ENOENT nobody has this name,
 * -EINVAL a limit is negative or the end is not after the beginning, else as add. */
int iso_gallery_set_validity(struct iso_gallery *gallery, const char *name,
                             const struct iso_validity *validity, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Returns 0 if n templates (1 or more) can be added for this name, else an error with a fault:
 * -EINVAL the name is new and bad, -EDQUOT there is no room. */
int iso_gallery_room(const struct iso_gallery *gallery, const char *name, int n,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* ---- out of service ---- */

/* Returns 0, or -EIO with the reason while the gallery is out of service. That happens if the disk
 * reported an error of a change and then could not be read, so that it is not known whether the
 * change is on it. Meanwhile nobody is found and nobody is a candidate. Every change and every
 * export fails: with -EIO, or with -ENOENT if it names a person. */
int iso_gallery_state(const struct iso_gallery *gallery, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads the gallery from the disk again if it is out of service; otherwise does nothing. -EIO: it
 * still is out of service. Earlier results of this header are no longer valid. */
int iso_gallery_recover(struct iso_gallery *gallery, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- copying between galleries ---- */

/* A person to be imported, with templates as iso_template_serialise() made them. */
struct iso_gallery_item {
    struct iso_person person; /* id and counts are ignored */
    size_t n;                 /* 1..ISO_GALLERY_TEMPLATES_MAX */
    struct {
        uint32_t algorithm;
        const void *bytes;
        size_t size;
        bool excluded; /* it does not teach the metric (site/site_record.h) */
    } templates[ISO_GALLERY_TEMPLATES_MAX];
};

/* Adds people, all of them or none, in one transaction. A person whose name is known replaces the
 * one here if `replace` is set, and is left out otherwise; *added is the number of people who were
 * added or have replaced another. -EINVAL a bad name, a bad template or a repeated name, -EDQUOT
 * the gallery would be too full; else as iso_gallery_add. Costs as much as the import has people,
 * unless it replaces somebody: then the whole gallery is read back. The listener counts steps. */
int iso_gallery_import(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                       bool replace, const struct iso_work_listener *listener, size_t *added,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Calls `each` for people (all, or the one of this name if it is not NULL) with all templates, also
 * those that cannot be used here. The bytes are valid during the call, and are wiped at the end. If
 * `each` returns a value other than 0, the function ends and returns it. -ENOENT nobody has this
 * name, -EBADMSG, -EIO, -ENOMEM. */
int iso_gallery_export(struct iso_gallery *gallery, const char *name,
                       int (*each)(void *context, const struct iso_gallery_item *item,
                                   struct iso_fault *fault),
                       void *context, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Deletes learned templates, in one transaction; *n is how many were deleted. People who had
 * learned templates get another id; names, dates and enrolled templates stay. People who have only
 * learned templates keep them. Errors of iso_gallery_export and iso_gallery_import; then nothing
 * has changed. */
int iso_gallery_forget_learned(struct iso_gallery *gallery, size_t *n, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- who may enter, where and when ---- */

/* An access record is a number of bytes that the gallery seals and stores, and does not interpret.
 * Each record belongs to a person (the person's id, 1 or more), to the site (id 0), or to the fleet
 * of which the door is a part (id -1). If a person gets another id, the record gets it, too; if the
 * person is removed, the record is deleted. An earlier program, which does not
 * know such a record, refuses to open a gallery that has one; if it knows no access records at all,
 * it refuses a gallery that has ever had one. */
enum { ISO_GALLERY_SITE = 0, ISO_GALLERY_FLEET = -1 };

/* The record of a person, of the site or of the fleet, and its size. NULL: there is none, or the
 * gallery is out of service. Valid until the next change. */
const void *iso_gallery_access(const struct iso_gallery *gallery, int64_t person, size_t *size);

/* Stores a record in place of the earlier one; size 0 deletes it. -ENOENT there is no such person,
 * -EFBIG more than ISO_GALLERY_ACCESS_MAX bytes, else as iso_gallery_add. */
int iso_gallery_set_access(struct iso_gallery *gallery, int64_t person, const void *bytes,
                           size_t size, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Keeps a copy of an access record, which the next call of iso_gallery_set_access() or
 * iso_gallery_apply() stores in its own transaction: both are on the disk, or neither is. size 0
 * deletes the record. A staged record takes the place of one that was staged before. unstage drops
 * it; the caller does so after the change, because a change that is refused leaves it. -EFBIG,
 * -ENOMEM. */
int iso_gallery_stage(struct iso_gallery *gallery, int64_t id, const void *bytes, size_t size,
                      struct iso_fault *fault) __attribute__((warn_unused_result));
void iso_gallery_unstage(struct iso_gallery *gallery);

/* ---- changes that a fleet makes ---- */

/* What is to become of one person. */
struct iso_gallery_change {
    int64_t person; /* the number of somebody who is here, who is replaced; 0: somebody new */
    bool remove;    /* removes the person; nothing below matters */
    bool keep;      /* the templates of the person stay, and so does the number; item.n is 0 */
    /* Name, dates and templates (0: somebody who is known by a card alone). Templates of another
     * algorithm are kept and counted, and take no part in searches. */
    struct iso_gallery_item item;
    const void *access; /* the access record; size 0: none */
    size_t access_size;
    int64_t number; /* out: the number of the person from now on; 0: removed */
};

/* Makes n changes (0 or more) and stores the staged record: all of it or nothing, in one
 * transaction, without reading the other people again. No person may be changed twice by one call.
 * -EINVAL a bad name, a bad template, two people with one name; -EEXIST somebody else has the name;
 * -ENOENT no such person; -EDQUOT the gallery would be too full; else as iso_gallery_import. */
int iso_gallery_apply(struct iso_gallery *gallery, struct iso_gallery_change *changes, size_t n,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* ---- keys, and which gallery it is ---- */

/* Seals everything with a new key and drops the old one. After a kill at any moment, all records
 * are sealed with one of the two keys, and the ring has this key. The listener counts records:
 * those of people and of templates. */
int iso_gallery_rotate(struct iso_gallery *gallery, const struct iso_work_listener *listener,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Counts a change that changes nobody, so that the gallery's files contain the present knowledge
 * about the other stores (heads.h). -EIO, -ENOSPC, ... */
int iso_gallery_renew(struct iso_gallery *gallery, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Seals the anchor with the newest key of the ring, so that older ones can be dropped. */
int iso_gallery_renew_anchor(struct iso_gallery *gallery, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Which gallery this is, and how often it was changed. The audit log contains both. */
struct iso_gallery_version {
    char gallery[17]; /* the first half of its id, in hexadecimal digits */
    uint64_t changes;
};

struct iso_gallery_version iso_gallery_version(const struct iso_gallery *gallery);

/* ---- finding people ---- */

/* All people, in the order of enrolment. */
const struct iso_person *iso_gallery_people(const struct iso_gallery *gallery, size_t *n);

/* How many people had the name of another person in another spelling when the gallery was opened.
 */
size_t iso_gallery_same_names(const struct iso_gallery *gallery);

/* Returns NULL if there is no such person. */
const struct iso_person *iso_gallery_find(const struct iso_gallery *gallery, const char *name);
const struct iso_person *iso_gallery_find_id(const struct iso_gallery *gallery, int64_t id);

/* The people that a search compares with: by their usable templates or, with a metric, by an index.
 * People without a usable template are left out. */
struct iso_candidate_list iso_gallery_everybody(struct iso_gallery *gallery);
struct iso_candidate_list iso_gallery_only(struct iso_gallery *gallery, int64_t person);

/* Sets the model of the running sensor, "" if it is not known: only people who were enrolled before
 * this class of sensor teach the metric (iso_site_index_set_sensor). */
void iso_gallery_set_sensor(struct iso_gallery *gallery, const char *model);

/* Whether a person does not teach the metric because no template of the person is of this class;
 * and how many people do not. */
bool iso_gallery_is_other(const struct iso_gallery *gallery, int64_t person);
size_t iso_gallery_site_other(const struct iso_gallery *gallery);

/* Takes a metric that was adapted to the people into use, if it is complete. Returns whether it
 * did. Never waits. */
bool iso_gallery_follow_site(struct iso_gallery *gallery);

/* What the people of the gallery have taught, and whether searches use it. */
struct iso_site_state iso_gallery_site(struct iso_gallery *gallery);

/* Excludes templates, so that the metric no longer learns from them. `reset` excludes all templates
 * that are enrolled now. `roll_back` excludes those of the last enrolment that the metric still
 * learns from, if it is among the last ISO_SITE_MARKS_MAX enrolments. The excluded templates still
 * identify their people, and the metric learns from later enrolments. *n receives the number of
 * templates that this call has excluded; if it is 0, nothing has changed. Errors of
 * iso_gallery_set_validity(); -EINVAL if the metric does not adapt. */
int iso_gallery_reset_site(struct iso_gallery *gallery, size_t *n, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_gallery_roll_back_site(struct iso_gallery *gallery, size_t *n, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* How many templates are excluded. */
size_t iso_gallery_site_excluded(struct iso_gallery *gallery);

/* The error rates of the present people, as iso_site_index_estimate() describes. False also while
 * the gallery is out of service. */
bool iso_gallery_site_estimate(struct iso_gallery *gallery, struct iso_site_estimate *out)
    __attribute__((warn_unused_result));

/* Opens the usable templates of one person from the database: at most `capacity`, which the caller
 * wipes. Takes some 0.1 ms for each template. -ENOENT nobody has this number; -EBADMSG a record is
 * not the stored one, -EIO, -ENOMEM; after an error `out` contains nothing of them. */
int iso_gallery_templates(struct iso_gallery *gallery, int64_t person, struct iso_template *out,
                          int capacity, int *n, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif

/* The state of the door's side of a fleet, and what its files call in each other. Internal to
 * firmware/fleet/door. */
#ifndef ISO_FIRMWARE_FLEET_DOOR_FLEET_STATE_H
#define ISO_FIRMWARE_FLEET_DOOR_FLEET_STATE_H

#include "firmware/fleet/door/fleet.h"
#include "firmware/fleet/door/fleet_index.h"
#include "firmware/fleet/door/fleet_record.h"
#include "firmware/fleet/message/lease.h"

enum { ISO__FLEET_WORDS = 3 }; /* bits of enum iso_fleet_work */

/* How many questions may wait for their answers. With many doors the hub may need longer than a
 * door waits until it asks again, and the answer to the first question is as good as it would have
 * been in time. */
enum { ISO__FLEET_QUESTIONS = 4 };

/* A question that waits for its answer. */
struct iso__fleet_question {
    uint8_t nonce[ISO_FLEET_NONCE_BYTES];
    struct iso_fleet_clocks at; /* a lease counts from this moment */
    size_t n;
    struct iso_fleet_place places[ISO_FLEET_ZONES_MAX]; /* that it has reported */
};

struct iso_fleet {
    struct iso_fleet_options options;
    bool unreadable; /* the stored record is of a newer program */
    bool reload;     /* the store may have another record than this one (fleet.c) */
    struct iso__fleet_record record;
    struct iso__fleet_index index;
    struct iso_fleet_term stored_term; /* that of the stored record */
    size_t n_questions;                /* the newest is the last one (fleet_ask.c) */
    struct iso__fleet_question questions[ISO__FLEET_QUESTIONS];
    /* A lease that counts when the door is level with what it lists. (fleet_level.c) */
    struct iso_fleet_term waiting; /* length_s 0: none */
    size_t n_waiting;
    struct iso_fleet_place waiting_for[ISO_FLEET_ZONES_MAX];
    /* What was told and handed out. (fleet_time.c, fleet_mail.c) */
    bool lease_held;
    uint64_t events_given, events_told;
    int64_t requests_after; /* the number of the last person who was handed out */
    unsigned work;
    int64_t told_ns[ISO__FLEET_WORDS];     /* by the clock of the boot */
    uint32_t snapshots;                    /* counts them */
    struct iso_fault fault;                /* of a wish of the hub that could not be done */
    struct iso_fleet_update_report update; /* as the link has told it (fleet_update.c) */
};

/* ---- fleet.c ---- */

/* Makes the fleet ready for a call: -ENOENT it belongs to none, -EPROTONOSUPPORT the record is of a
 * newer version, -EIO the store is out of service, -ENOMEM. */
int iso__fleet_ready(struct iso_fleet *fleet, struct iso_fault *fault);

/* Stores changes of people together with a record, which then is the fleet's. The index is not
 * changed, but counts as up to date afterwards. */
int iso__fleet_store(struct iso_fleet *fleet, const struct iso__fleet_record *draft,
                     struct iso_gallery_change *changes, size_t n, struct iso_fault *fault);

struct iso_fleet_clocks iso__fleet_now(const struct iso_fleet *fleet);

/* Signs a FETCH of this door, whose nonce and time it sets. (fleet_ask.c) */
int iso__fleet_sign_fetch(struct iso_fleet *fleet, struct iso_fleet_fetch *fetch,
                          struct iso_fleet_bytes *out, struct iso_fault *fault);

/* Adds the members about the image to a health. (fleet_update.c) */
void iso__fleet_write_update(const struct iso_fleet *fleet, struct iso_json_line *line);

/* A change of the hub that is to be recorded. Texts may be NULL. */
struct iso__fleet_note {
    const char *reason, *person, *before, *after;
    const struct iso_fleet_id *zone;
    uint64_t sequence; /* 0: none */
};

/* Records it. (fleet.c) */
int iso__fleet_note(struct iso_fleet *fleet, const struct iso__fleet_note *note, bool wait,
                    struct iso_fault *fault);

/* Keeps why a wish of the hub was not done, for the status. (fleet.c) */
void iso__fleet_complain(struct iso_fleet *fleet, const struct iso_fault *fault);

/* Says, and keeps, that the hub sends what only a newer version of this program reads. (fleet.c) */
void iso__fleet_complain_of_newer(struct iso_fleet *fleet);

__attribute__((format(printf, 3, 4))) void iso__fleet_say(const struct iso_fleet *fleet,
                                                          int priority, const char *format, ...);

/* ---- people (fleet_people.c) ---- */

enum { ISO__FLEET_BATCH = 32 };

/* Changes of people that are stored together. */
struct iso__fleet_batch;

/* Begins changes that a zone of the fleet's record makes; `seen` is the number of a snapshot whose
 * people are put, or 0. -ENOMEM. */
int iso__fleet_batch_new(struct iso_fleet *fleet, const struct iso_fleet_id *zone, uint8_t bit,
                         uint64_t sequence, uint32_t seen, struct iso__fleet_batch **out);
void iso__fleet_batch_free(struct iso__fleet_batch *batch);

/* Adds what becomes of a person: by a PUT; by a REMOVE, or because the zone is gone. A full batch
 * is stored first, with the fleet's present record. */
int iso__fleet_put(struct iso__fleet_batch *batch, const struct iso_fleet_person *person,
                   struct iso_fault *fault);
int iso__fleet_withdraw(struct iso__fleet_batch *batch, const struct iso_fleet_id *person,
                        struct iso_fault *fault);

/* Stores the rest together with a record. */
int iso__fleet_batch_end(struct iso__fleet_batch *batch, const struct iso__fleet_record *draft,
                         struct iso_fault *fault);

/* Removes the grants of the batch's zones from everybody whom its snapshot did not have, if it is
 * one. Then as batch_end. */
int iso__fleet_withdraw_all(struct iso__fleet_batch *batch, const struct iso__fleet_record *draft,
                            struct iso_fault *fault);

/* ---- policy and lockdown (fleet_rules.c) ---- */

/* The zone of the draft brings a policy or a lockdown; the draft is stored with it. */
int iso__fleet_take_policy(struct iso_fleet *fleet, struct iso__fleet_record *draft,
                           const struct iso__fleet_zone *zone, const char *text, size_t length,
                           struct iso_fault *fault);
int iso__fleet_take_lockdown(struct iso_fleet *fleet, struct iso__fleet_record *draft,
                             struct iso__fleet_zone *zone, bool on, struct iso_fault *fault);

/* ---- the answer to a question (fleet_lease.c) ---- */

int iso__fleet_take_lease(struct iso_fleet *fleet, const void *bytes, size_t size,
                          enum iso_fleet_outcome *outcome, struct iso_fault *fault);

/* Gives a draft the term of the lease that answers a question, if its zones are level with what the
 * lease lists. Otherwise the earlier term goes on, unless it would end later, and the lease waits.
 * (fleet_level.c) */
void iso__fleet_give_term(struct iso_fleet *fleet, struct iso__fleet_record *draft,
                          const struct iso__fleet_question *question,
                          const struct iso_fleet_lease *lease);

/* Called after the record has changed: takes a waiting lease if the zones are level now. */
void iso__fleet_level(struct iso_fleet *fleet);

/* Says that the hub has lost something of a zone; `sequence` is the one at the hub. */
void iso__fleet_say_behind(const struct iso_fleet *fleet, const struct iso__fleet_zone *zone,
                           uint64_t sequence);

/* Goes to the next epoch of a zone of a draft if its place is the base of it. */
void iso__fleet_advance(struct iso__fleet_zone *zone);

#endif

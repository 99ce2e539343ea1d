/* The door's side of a fleet: what one appliance keeps of the hub it belongs to, and what it does
 * with the hub's messages (firmware/fleet/message/envelope.h). It has no network; isotherm-link
 * carries the messages.
 *
 *   hub --messages--> iso_fleet_receive(), iso_fleet_snapshot() --one transaction--> gallery
 *   iso_fleet_question(), _fetch(), _events(), _requests() --messages--> hub
 *   iso_fleet_admission() --> the decision about somebody at the door
 *
 * Every message of the hub is verified with the key of the hub that the door has joined, and its
 * zone, epoch, sequence, digest, door and nonce are compared with what the door has. What does not
 * fit is refused and changes nothing. A change of people and the place of the zone after it are on
 * the disk together or not at all, so a kill at any moment repeats a message at most.
 *
 * States of a zone, by its place and what is known besides:
 *
 *   NEW: LEASE has listed it, and the door has no key.
 *     - KEY: FOLLOWS, or it wants a snapshot if the zone has a history.
 *   FOLLOWS:
 *     - the next DELTA: FOLLOWS, one change further.
 *     - KEY of a new epoch: it has both keys, and uses the new one from the base of the epoch on.
 *     - KEY with reset, or from a base that the door's history does not have: it wants a snapshot.
 *     - LEASE with an earlier place than the question, or of another history: "behind". The hub
 *       has lost something, and the door keeps what it has.
 *   Wants a snapshot:
 *     - SNAPSHOT: FOLLOWS.
 *   Any:
 *     - LEASE does not list it: it is gone, with its grants.
 *
 * A person stays as long as a zone grants. Of two zones that bring the same person, the higher
 * revision wins. Whoever was enrolled here has an id, too (iso_fleet_request_id()); a PUT with that
 * id, or with the same name, replaces this person.
 *
 * A lease counts from the moment when the door is level with the places that it lists; until then
 * the earlier one goes on.
 *
 * Who is admitted: a person of the fleet while the lease holds, or with offline_ok always; somebody
 * who was enrolled here if the last LEASE said so.
 *
 * All calls come from one thread; nothing waits but for the disk. */
#ifndef ISO_FIRMWARE_FLEET_DOOR_FLEET_H
#define ISO_FIRMWARE_FLEET_DOOR_FLEET_H

#include "firmware/audit/audit.h"
#include "firmware/contract/fleet_words.h"
#include "firmware/contract/json_line.h"
#include "firmware/fleet/door/fleet_store.h"
#include "firmware/fleet/door/fleet_term.h"
#include "firmware/fleet/message/door_mail.h"
#include "firmware/fleet/message/membership.h"
#include "firmware/fleet/order/update_order.h"
#include "firmware/policy/credential/credential_record.h"

struct iso_fleet;

/* What a door of a fleet needs of the appliance around it. */
struct iso_fleet_host {
    void *context;
    /* REQUIRED. The appliance's own pairs, which fleet.c wipes after each use. */
    void (*keys)(void *context, struct iso_fleet_signer *signer,
                 struct iso_fleet_receiver *receiver);
    void (*clocks)(void *context, struct iso_fleet_clocks *now); /* REQUIRED */
    /* REQUIRED. Writes a record of what will be done, and with `wait` waits until it and all before
     * it are on the disk. After an error it must not be done. */
    int (*record)(void *context, const struct iso_audit_record *record, bool wait,
                  struct iso_fault *fault);
    /* The number of the last record of the log; reading it (iso_audit_read()). REQUIRED. */
    uint64_t (*last_event)(void *context);
    int (*read_log)(void *context, uint64_t from, uint32_t most,
                    int (*each)(void *context, const char *line), void *each_context);
    /* Stores a policy ("": none) together with the staged record of the fleet. -EINVAL, -EFBIG: the
     * policy does not fit this door, and nothing has changed. NULL: the door has no policies. */
    int (*policy)(void *context, const char *json, const char *who, struct iso_fault *fault);
    /* Begins or ends the lockdown. NULL: there is none. */
    int (*lockdown)(void *context, bool on, struct iso_fault *fault);
    /* Somebody who was here under a number and a name was changed, and has the number `now`; 0: the
     * person was removed. Whatever is kept in memory of the person is outdated. NULL: nothing is.
     */
    void (*changed)(void *context, int64_t person, const char *name, int64_t now);
    /* Adds members about the door, for people, to the health that a QUESTION tells. NULL: none. */
    void (*health)(void *context, struct iso_json_line *line);
    /* Whether somebody is at the door, or has the camera. NULL: it is not known. */
    bool (*busy)(void *context);
    /* Whether the machine may restart for an update now, if nobody is there. NULL: always. */
    bool (*may_restart)(void *context);
    /* A line for the system's log; names nobody. NULL: none. */
    void (*say)(void *context, int priority, const char *line);
};

struct iso_fleet_options {
    struct iso_fleet_store store; /* its object outlives the fleet */
    struct iso_fleet_host host;
    uint32_t algorithm; /* whose templates the door searches */
};

/* Reads what the store has of a fleet. Returns 0 also if a newer program has written it: then the
 * door belongs to a fleet, and nobody of it is admitted. -EIO the store is out of service, -ENOMEM.
 */
int iso_fleet_open(const struct iso_fleet_options *options, struct iso_fleet **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));
void iso_fleet_close(struct iso_fleet *fleet); /* wipes; NULL is accepted */

/* ---- belonging to a fleet ---- */

bool iso_fleet_is_member(const struct iso_fleet *fleet);

/* The name of the hub, "" without one; whether the door's policy came from it. */
const char *iso_fleet_hub_name(const struct iso_fleet *fleet);
bool iso_fleet_has_policy(const struct iso_fleet *fleet);

/* Takes a MEMBERSHIP; recorded. `who` describes the user who asks. Of the same hub it replaces the
 * earlier one. -EBADMSG, -EKEYREJECTED it is changed or for another door, -EEXIST the door belongs
 * to another fleet, else as iso_gallery_apply. */
int iso_fleet_join(struct iso_fleet *fleet, const void *bytes, size_t size, const char *who,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Forgets the fleet, its keys and all people who came from it; recorded. The policy and a lockdown
 * stay, because without them more people might enter. -ENOENT it belongs to none. */
int iso_fleet_leave(struct iso_fleet *fleet, const char *who, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- the hub's messages; -ENOENT the door belongs to no fleet ---- */

/* Handles a KEY, DELTA, HEAD, LEASE or ACK. A message that is refused is no error. *zone: that of
 * KEY, DELTA and HEAD; else zeros. -EIO, -ENOSPC, -ENOMEM, ...: it could not be stored, and nothing
 * has changed; it may come again. */
int iso_fleet_receive(struct iso_fleet *fleet, const void *bytes, size_t size,
                      enum iso_fleet_outcome *outcome, struct iso_fleet_id *zone,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Handles a SNAPSHOT: puts what is new or newer, and removes the grants that it does not have. It
 * is stored in several transactions, the place with the last one. An error in between leaves a part
 * of it, and the same file may come again. */
int iso_fleet_snapshot(struct iso_fleet *fleet, const uint8_t *bytes, size_t size,
                       enum iso_fleet_outcome *outcome, struct iso_fleet_id *zone,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same with a file, from its beginning. It is copied first, unless it is sealed against
 * shrinking (memfd_create(2)). -EINVAL it is no file, -EFBIG more than ISO_FLEET_SNAPSHOT_MAX
 * bytes, -EIO. */
enum { ISO_FLEET_SNAPSHOT_MAX = 256 << 20 };
int iso_fleet_snapshot_file(struct iso_fleet *fleet, int fd, enum iso_fleet_outcome *outcome,
                            struct iso_fleet_id *zone, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- messages for the hub, which the caller frees; -ENOENT the door belongs to no fleet ---- */

/* A QUESTION with a new nonce. The answers to it and to the three before it are accepted, but none
 * to an earlier question than one that was answered. A lease counts from its own question. */
int iso_fleet_question(struct iso_fleet *fleet, struct iso_fleet_bytes *out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* A FETCH for what comes after the door's place. -ENXIO the zone is not the door's. */
int iso_fleet_fetch(struct iso_fleet *fleet, const struct iso_fleet_id *zone,
                    enum iso_fleet_wanted what, struct iso_fleet_bytes *out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* EVENTS with at most `most` records after number `after`, fewer if they are long. *last is the
 * number of the last one; 0: there are none, and `out` stays empty. */
int iso_fleet_events(struct iso_fleet *fleet, uint64_t after, uint32_t most,
                     struct iso_fleet_bytes *out, uint64_t *last, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Calls `each` with a REQUEST for people who were enrolled here and are not of the fleet, for some
 * megabytes at a time; the next call goes on with the others. If there are others, iso_fleet_time()
 * tells of requests again. */
int iso_fleet_requests(struct iso_fleet *fleet,
                       void (*each)(void *context, const void *bytes, size_t size),
                       void *each_context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The id that somebody has who was enrolled at a door, in the store of this name. */
struct iso_fleet_id iso_fleet_request_id(const struct iso_fleet_id *door, const char *store,
                                         int64_t person);

/* ---- updates of the image, which the link fetches; -ENOENT the door belongs to no fleet ---- */

/* What the next QUESTIONs tell about the image; kept in memory until the fleet is closed. *busy:
 * somebody is at the door now, so the machine must not restart. -EINVAL a version or a board is
 * none, or the fault has more than one line. */
int iso_fleet_set_update(struct iso_fleet *fleet, const struct iso_fleet_update_report *report,
                         bool *busy, struct iso_fault *fault) __attribute__((warn_unused_result));

/* A FETCH for the part of an update that begins after so many bytes. */
int iso_fleet_fetch_update(struct iso_fleet *fleet, const struct iso_fleet_id *rollout,
                           uint64_t after, struct iso_fleet_bytes *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- state ---- */

struct iso_fleet_status {
    const struct iso_fleet_membership *member;
    uint64_t last_event, acked;
    bool lease_given;      /* there was ever a lease */
    int64_t lease_left_ns; /* 0: it is over */
    uint32_t lease_s;      /* as the hub said it: 0 means ISO_FLEET_LEASE_ONLINE_S */
    bool local_people;
    size_t n; /* zones, the home zone first */
    struct iso_fleet_place places[ISO_FLEET_ZONES_MAX];
    bool wants_snapshot[ISO_FLEET_ZONES_MAX];
    bool behind;       /* the hub knows less of a zone than this door */
    uint32_t pending;  /* people who were enrolled here */
    uint32_t people;   /* people of the fleet */
    const char *fault; /* what of the hub's wishes this door could not do; "": nothing */
};

/* -ENOENT. */
int iso_fleet_get_status(struct iso_fleet *fleet, struct iso_fleet_status *out,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Whether somebody with this credential may be admitted, as far as the fleet is concerned. */
enum iso_fleet_admission {
    ISO_FLEET_NO_LEASE = 0, /* a person of the fleet, and the lease is over */
    ISO_FLEET_NOT_APPROVED, /* enrolled here, and the hub does not admit such people */
    ISO_FLEET_MAY_ENTER,
};

enum iso_fleet_admission iso_fleet_admission(const struct iso_fleet *fleet,
                                             const struct iso_credential_record *record);

/* "no lease: the hub has not answered since 2026-11-26 04:30"; "" while it holds. */
enum { ISO_FLEET_WHY_SIZE = 96 };
const char *iso_fleet_why(const struct iso_fleet *fleet, char text[ISO_FLEET_WHY_SIZE]);

/* What waits for the link: bits. */
enum iso_fleet_work {
    ISO_FLEET_WORK_EVENTS = 1,
    ISO_FLEET_WORK_REQUESTS = 2,
    ISO_FLEET_WORK_PLACES = 4,
};

/* Records and says that the lease ends or holds again, and returns what waits: each bit at most
 * once a second and once for the same work. *due_ns: in how many nanoseconds to call again at the
 * latest. */
unsigned iso_fleet_time(struct iso_fleet *fleet, int64_t *due_ns);

#endif

/* The link of one door to its hub: it carries messages between the daemon of the door
 * (link_daemon.h), the broker (link_mqtt.h) and the hub's HTTPS (link_http.h). It has the network
 * and no secret of the fleet. It stores nothing. Many links may live in one process and one event
 * loop.
 *
 *   phase        goes on to
 *   AWAY         OFFLINE      the daemon answers, and the door belongs to a fleet
 *   OFFLINE      SUBSCRIBING  the broker has accepted the link
 *   SUBSCRIBING  ASKING       the broker has accepted all subscriptions; a QUESTION is sent
 *   ASKING       ONLINE       the daemon has accepted a LEASE
 *   ONLINE       SUBSCRIBING  the door has a zone that it had not: its topics are subscribed
 *   the last 3   OFFLINE      the connection is lost
 *   every one    AWAY         the daemon does not answer, or cannot store something
 *
 * Subscribing comes first and comparing second, so that no change falls between the two: what is
 * published before the subscription is in the answer to the question, what is published after it
 * arrives.
 *
 * UPDATE goes to whoever installs updates, and to no daemon. A message of the broker reaches the
 * daemon only if its kind fits its topic, the hub has signed it, and it names this door or a zone
 * of it. What the daemon then says decides:
 *
 *   APPLIED   a change is confirmed by a QUESTION; after a KEY, a LEASE or a snapshot the zones of
 *             the door are read and compared again
 *   KNOWN     nothing
 *   GAP       the missing deltas are fetched
 *   WHOLE     the zone is fetched whole
 *   NO_KEY    a QUESTION: KEY comes with the answer
 *   REFUSED   nothing; it is counted
 *
 * One fetch at a time is made for a door:
 *
 *   IDLE      LOADING   a zone lacks something, and the wait after a failure is over
 *   LOADING   APPLYING  the reply is there
 *             IDLE      it failed
 *   APPLYING  IDLE      its messages are handed over, or one does not fit
 *
 * Deltas that arrive meanwhile are handed over, too. After each fetch the places are compared with
 * the newest that the hub has named, and the link fetches again until they are level. A fetch that
 * brought nothing makes the next one wait (link_backoff.h).
 *
 * A QUESTION is not sent while an earlier one is unanswered; after 10 s without an answer it is
 * sent again, and the answers to both count (firmware/fleet/door/fleet.h). There is at least one
 * second between two. Without a reason it is sent after min(60 s, lease / 8), and after 5 s if the
 * lease is 0, each shortened by up to a tenth, so that doors do not ask at the same moment. After a
 * QUESTION with a reason, which many doors have at the same moment (a change, a broker that came
 * back), the time is shortened by up to nine tenths, so that they do not ask together from then on.
 *
 * Events of the door's log are sent from the last acknowledged number on, in batches of 64 of which
 * 2 may be unacknowledged; after a loss of the connection, and after 10 s without an
 * acknowledgement, from the last acknowledged number again. The hub stores each number once. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_H

#include "firmware/fleet/link/link_daemon.h"
#include "firmware/fleet/link/link_http.h"
#include "firmware/fleet/link/link_mqtt.h"

struct link_door;

enum link_phase {
    LINK_AWAY,
    LINK_OFFLINE,
    LINK_SUBSCRIBING,
    LINK_ASKING,
    LINK_ONLINE,
    LINK_PHASES
};

struct link_setup {
    sd_event *event;
    struct iso_link_daemon daemon;
    struct link_http *http; /* belongs to the caller, who frees it after the link */
    struct link_broker broker;
    const char *hub_url; /* "https://HOST:PORT"; its authority is broker.ca_file */
    const char *folder;  /* of replies (link_http.h); NULL: in memory */
    /* Orders for updates of the image, which the hub has signed for this door (ordered), and its
     * answers to questions, behind which an order that holds comes again (answered). Both may be
     * NULL: orders then do nothing. */
    void *update_context;
    void (*ordered)(void *context, const struct iso_fleet_update *order);
    void (*answered)(void *context);
    void *note_context;
    /* Takes one line for people about what went wrong; may be NULL. */
    void (*note)(void *context, const char *line);
};

/* What a link has done since it was made. */
struct link_report {
    enum link_phase phase;
    uint64_t connections, questions, leases;
    uint64_t deltas;    /* that the daemon has applied, from the broker or fetched */
    uint64_t fetches;   /* replies of deltas, of which each may be empty */
    uint64_t snapshots; /* that the daemon has applied */
    uint64_t failed_fetches;
    uint64_t forged;                    /* messages that did not reach the daemon */
    uint64_t refused;                   /* messages that the daemon has refused */
    uint64_t events_sent, events_acked; /* numbers of records */
    uint64_t requests;
    uint64_t missing; /* changes of all zones that the hub has named and the daemon does not have */
};

/* Makes a link, which asks the daemon at once from the event loop. The texts of the setup are
 * copied. The caller frees *out. -ENOMEM, -EINVAL, -EIO, errors of the event loop. */
int link_door_new(const struct link_setup *setup, struct link_door **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void link_door_free(struct link_door *door);

/* The daemon has come back, or belongs to another fleet: it is asked at once. */
void link_door_wake(struct link_door *door);

/* The daemon says that something waits: the word of the signal FleetWork. Other words do nothing.
 */
void link_door_work(struct link_door *door, const char *what);

/* Connects to the broker anew, with the present certificate. */
void link_door_renew(struct link_door *door);

struct link_report link_door_report(const struct link_door *door);

/* "away", "offline", ... */
const char *link_phase_word(enum link_phase phase);

#endif

/* The parts of a link (link.h), for its own sources. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_INNER_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_INNER_H

#include "firmware/fleet/link/link.h"
#include "firmware/fleet/link/link_backoff.h"

#define LINK_S_US UINT64_C(1000000)

enum {
    LINK_NOTE_SIZE = 384,
    LINK_EVENTS_BATCH = 64,
    LINK_EVENTS_WINDOW = 2, /* batches that are not acknowledged */
};

/* Moments at which a link does something. */
enum link_due {
    LINK_DUE_DAEMON,   /* ask the daemon for its state */
    LINK_DUE_QUESTION, /* send a QUESTION */
    LINK_DUE_ANSWER,   /* the LEASE is late */
    LINK_DUE_FETCH,    /* look whether something is to be fetched */
    LINK_DUE_APPLY,    /* hand over the next part of a reply */
    LINK_DUE_EVENTS,   /* send events */
    LINK_DUE_ACK,      /* the ACK is late */
    LINK_DUE_REQUESTS, /* send requests */
    LINK_DUES
};

/* A zone of the door. */
struct link_zone {
    struct iso_fleet_place mine;
    uint64_t target;      /* the sequence that the hub has named */
    bool is_whole_wanted; /* by the daemon, when it was last asked */
    bool is_whole_due;    /* a message or a reply has shown it since the last snapshot */
};

struct link_fetch {
    struct link_http_request *request; /* while the reply is loaded */
    int fd;                            /* while it is applied; else -1 */
    uint64_t size, offset;             /* of the reply, and how far it is handed over */
    struct iso_fleet_id zone;
    uint64_t before; /* the sequence of the zone when the fetch began */
    enum iso_fleet_wanted what;
    bool has_news; /* something of it was applied */
    struct link_backoff backoff;
    uint64_t not_before_us; /* the next one */
    size_t turn; /* the zone that is looked at first, so that none has to wait for others */
};

struct link_events {
    uint64_t acked, sent;              /* numbers of records */
    uint64_t last[LINK_EVENTS_WINDOW]; /* of each batch that is not acknowledged */
    size_t n;
    uint32_t timeouts; /* in a row */
};

/* Requests that were sent since they were last asked for. */
struct link_requests {
    struct iso_fleet_id *sent; /* persons */
    size_t n, capacity;
    uint64_t again_us;    /* when all are sent again; 0: nothing was sent */
    uint64_t round_bytes; /* of the present round */
    int round_id;         /* of its last message */
    bool is_cut;          /* some of them have to wait for the next round */
};

struct link_door {
    sd_event *event;
    struct iso_link_daemon daemon;
    struct link_http *http;
    struct link_broker broker; /* its texts belong to the link */
    char *hub_url, *folder;
    uint8_t answered_nonce[ISO_FLEET_NONCE_BYTES]; /* of the LEASE that was taken last */
    void *update_context;
    void (*ordered)(void *context, const struct iso_fleet_update *order);
    void (*answered)(void *context);
    void *note_context;
    void (*note)(void *context, const char *line);

    sd_event_source *timer;
    uint64_t due_us[LINK_DUES]; /* 0: never */

    bool has_daemon; /* it has answered the last call */
    struct iso_link_status status;
    struct link_zone zones[ISO_FLEET_ZONES_MAX]; /* of status.places */
    size_t zone_count;

    struct link_mqtt *mqtt;
    struct iso_fleet_id connected_as; /* the door of the connection */
    char topic_in[ISO_FLEET_TOPIC_SIZE], topic_out[ISO_FLEET_TOPIC_SIZE];
    struct iso_fleet_id subscribed[ISO_FLEET_ZONES_MAX];
    size_t subscribed_count;
    int subscription; /* the id of the last one; is_subscribed: it is accepted */
    bool is_subscribed, has_lease;

    bool is_asking;      /* a QUESTION is unanswered */
    bool asks_again;     /* there was a reason to ask meanwhile */
    bool has_reason;     /* the QUESTION has one besides the time */
    uint32_t unanswered; /* QUESTIONs in a row */
    uint64_t asked_us;   /* when the last one was sent; 0: never */

    struct link_fetch fetch;
    struct link_events events;
    struct link_requests requests;
    struct link_report report;
};

/* ---- link_time.c ---- */

uint64_t link_now_us(const struct link_door *door);

/* Does something at a time, or earlier if it was to happen earlier; and never. */
void link_at(struct link_door *door, enum link_due due, uint64_t at_us);
void link_in(struct link_door *door, enum link_due due, uint64_t delay_us);
void link_never(struct link_door *door, enum link_due due);

/* Sets the timer to the earliest moment. */
void link_rearm(struct link_door *door);

uint64_t link_random(void);

/* ---- link.c ---- */

/* One line for people. */
void link_note(const struct link_door *door, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* What a call of the daemon returned. After an error the link is AWAY, and asks again. Returns r.
 */
int link_daemon_result(struct link_door *door, int r, const struct iso_fault *fault);

/* The same for a call that can wait: only if the daemon is gone, the link is AWAY; another error is
 * noted. Returns r. */
int link_daemon_minor_result(struct link_door *door, int r, const struct iso_fault *fault);

/* ---- link_zones.c ---- */

/* Reads the state of the daemon: its zones, and what they want. Returns 0 or the error. */
int link_zones_read(struct link_door *door);

struct link_zone *link_zone_of(struct link_door *door, const struct iso_fleet_id *id);

/* Whether a zone lacks something, and whether that is a snapshot. */
bool link_zone_lacks(const struct link_zone *zone);
bool link_zone_lacks_all(const struct link_zone *zone);

/* The hub has named this sequence of a zone: what the door lacks is fetched. */
void link_zone_aim(struct link_door *door, struct link_zone *zone, uint64_t target);

/* Subscribes to the topics of new zones, and to those of lost ones no longer. With `all` to every
 * topic of the door. */
void link_zones_subscribe(struct link_door *door, bool all);

/* ---- link_receive.c ---- */

/* A message of the broker. */
void link_receive(struct link_door *door, const char *topic, const void *bytes, size_t size);

/* Hands over a message that the hub has signed and this version cannot read: the daemon refuses it,
 * and tells the hub why. */
void link_hand_newer(struct link_door *door, const void *bytes, size_t size);

/* Acts on what the daemon says of a message or of a snapshot. */
void link_act(struct link_door *door, enum iso_fleet_kind kind,
              const struct iso_link_outcome *outcome);

/* ---- link_ask.c ---- */

/* Asks soon: as soon as the rules of link.h permit. */
void link_ask(struct link_door *door);
void link_ask_now(struct link_door *door);  /* LINK_DUE_QUESTION */
void link_ask_late(struct link_door *door); /* LINK_DUE_ANSWER */

/* After which time the next QUESTION is sent if there is no reason for an earlier one, in
 * microseconds; `random` is a uniform random number. Pure. */
uint64_t link_period_us(uint32_t lease_s, bool had_reason, uint64_t random);

/* The daemon has accepted an answer. */
void link_answered(struct link_door *door);

/* ---- link_fetch.c, link_apply.c ---- */

void link_fetch_next(struct link_door *door);  /* LINK_DUE_FETCH */
void link_fetch_apply(struct link_door *door); /* LINK_DUE_APPLY */

/* Ends the fetch that is being made. A failure makes the next one wait, for at least least_s. */
void link_fetch_end(struct link_door *door, bool has_failed, uint32_t least_s);
void link_fetch_cancel(struct link_door *door);

/* ---- link_events.c ---- */

void link_events_start(struct link_door *door); /* connected: from the last acknowledged one on */
void link_events_send(struct link_door *door);  /* LINK_DUE_EVENTS */
void link_events_late(struct link_door *door);  /* LINK_DUE_ACK */

/* The hub has stored all events up to this number, as the daemon knows now. */
void link_events_acked(struct link_door *door, uint64_t number);

/* ---- link_requests.c ---- */

void link_requests_start(struct link_door *door);

/* The hub did not hear something: all are sent again soon. */
void link_requests_unheard(struct link_door *door);
void link_requests_send(struct link_door *door); /* LINK_DUE_REQUESTS */
void link_requests_published(struct link_door *door, int id);
void link_requests_free(struct link_door *door);

#endif

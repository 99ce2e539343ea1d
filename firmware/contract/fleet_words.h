/* The part of the bus (contract.h) by which isotherm-link reaches the daemon of its door, and the
 * words of it. The user isotherm-link may call all of these methods except FleetJoin and
 * FleetLeave, which are for root. A link that could join another fleet could choose who is let in.
 */
/* clang-format off */
/*   GetFleet() -> a{sv}             the keys ISO_CONTRACT_FLEET_... below; {} : it belongs to no fleet
 *   FleetJoin(ay membership)        MEMBERSHIP of firmware/fleet/message/envelope.h, which names this
 *                                   door's own key; recorded. Refused while it belongs to another fleet
 *   FleetLeave()                    forgets the fleet, its keys, and all people who came from it; recorded
 *   FleetQuestion() -> ay           QUESTION with a new nonce
 *   FleetReceive(ay message) -> ss  KEY, DELTA, HEAD, LEASE or ACK; what became of it: a word
 *                                   ISO_CONTRACT_FLEET_APPLIED ..., and the zone ("": none, or several)
 *   FleetFetch(s zone, s what) -> ay  FETCH; what: "deltas" or "snapshot"
 *   FleetSnapshot(h file) -> ss     a SNAPSHOT as a file; reply as FleetReceive
 *   FleetEvents(t after, u most) -> ayt  EVENTS with the records after this number, and the number of
 *                                   the last one (0: there are none)
 *   FleetRequests() -> aay          REQUESTs for people who were enrolled here and are not approved
 *   FleetUpdate(s state, s rollout, s version, s board, s fault) -> b
 *                                   what the next QUESTIONs tell about the image of the door
 *                                   (firmware/fleet/order/update_order.h); whether somebody is at the
 *                                   door, or it waits for a restart and [fleet] restart_hours allows
 *                                   none, so that the machine must not restart now
 *   FleetFetchUpdate(s rollout, t after) -> ay  FETCH for the part of an update that begins after so
 *                                   many bytes
 *
 *   signal FleetWork(s what)        something waits: "events", "requests" or "places"; at most once a
 *                                   second each */
/* clang-format on */
#ifndef ISO_FIRMWARE_CONTRACT_FLEET_WORDS_H
#define ISO_FIRMWARE_CONTRACT_FLEET_WORDS_H

#define ISO_CONTRACT_GET_FLEET          "GetFleet"
#define ISO_CONTRACT_FLEET_JOIN         "FleetJoin"
#define ISO_CONTRACT_FLEET_LEAVE        "FleetLeave"
#define ISO_CONTRACT_FLEET_QUESTION     "FleetQuestion"
#define ISO_CONTRACT_FLEET_RECEIVE      "FleetReceive"
#define ISO_CONTRACT_FLEET_FETCH        "FleetFetch"
#define ISO_CONTRACT_FLEET_SNAPSHOT     "FleetSnapshot"
#define ISO_CONTRACT_FLEET_EVENTS       "FleetEvents"
#define ISO_CONTRACT_FLEET_REQUESTS     "FleetRequests"
#define ISO_CONTRACT_FLEET_UPDATE       "FleetUpdate"
#define ISO_CONTRACT_FLEET_WORK         "FleetWork"
#define ISO_CONTRACT_FLEET_FETCH_UPDATE "FleetFetchUpdate"

/* The door belongs to no fleet; of all methods but GetFleet and FleetJoin. */
#define ISO_CONTRACT_ERROR_NO_FLEET "org.isotherm.Error.NoFleet"

/* What waits for the link, of the signal. */
#define ISO_CONTRACT_FLEET_WORK_EVENTS   "events"
#define ISO_CONTRACT_FLEET_WORK_REQUESTS "requests"
#define ISO_CONTRACT_FLEET_WORK_PLACES   "places"

/* What became of a message of the hub. */
enum iso_fleet_outcome {
    ISO_FLEET_APPLIED, /* it is stored */
    ISO_FLEET_KNOWN,   /* it was stored before */
    ISO_FLEET_GAP,     /* deltas before it are missing: fetch them */
    ISO_FLEET_NO_KEY,  /* the key of its epoch is missing: ask a question, KEY comes with the answer
                        */
    ISO_FLEET_WHOLE,   /* the zone has to be fetched whole: a snapshot */
    ISO_FLEET_REFUSED, /* changed, replayed, of another zone, another history or an old epoch */
    ISO_FLEET_OUTCOMES
};

/* The words of the bus, in the order of the outcomes. */
#define ISO_CONTRACT_FLEET_WORDS                                \
    {                                                           \
        "applied", "known", "gap", "no-key", "whole", "refused" \
    }

#define ISO_CONTRACT_FLEET_DELTAS_WORD   "deltas"
#define ISO_CONTRACT_FLEET_SNAPSHOT_WORD "snapshot"

/* Keys of GetFleet. */
#define ISO_CONTRACT_FLEET_DOOR       "door"       /* s: a UUID */
#define ISO_CONTRACT_FLEET_DOOR_NAME  "door-name"  /* s */
#define ISO_CONTRACT_FLEET_HUB_NAME   "hub-name"   /* s */
#define ISO_CONTRACT_FLEET_HUB_SIGNS  "hub-signs"  /* s: 64 hexadecimal digits */
#define ISO_CONTRACT_FLEET_LEASE      "lease"      /* s: "held", "over" or "none" (never had) */
#define ISO_CONTRACT_FLEET_LEASE_LEFT "lease-left" /* x: seconds */
#define ISO_CONTRACT_FLEET_LEASE_S    "lease-s"    /* u: length of the last one; 0: see lease.h */
#define ISO_CONTRACT_FLEET_LAST_EVENT "last-event" /* t */
#define ISO_CONTRACT_FLEET_ACKED      "acked"      /* t */
#define ISO_CONTRACT_FLEET_ZONES                                                                 \
    "zones"                                  /* a(sttsb): zone, epoch, sequence, digest, wants a \
                                              * snapshot */
#define ISO_CONTRACT_FLEET_PENDING "pending" /* u: people who wait for approval */
#define ISO_CONTRACT_FLEET_PEOPLE  "people"  /* u: people who came from the hub */
#define ISO_CONTRACT_FLEET_BEHIND  "hub-behind" /* b: the hub knows less than this door */
#define ISO_CONTRACT_FLEET_FAULT   "fault" /* s: what of the hub's wishes this door could not do */

/* The words of ISO_CONTRACT_FLEET_LEASE. */
#define ISO_CONTRACT_FLEET_LEASE_HELD "held"
#define ISO_CONTRACT_FLEET_LEASE_OVER "over"
#define ISO_CONTRACT_FLEET_LEASE_NONE "none"

#endif

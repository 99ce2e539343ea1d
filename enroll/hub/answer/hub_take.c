/* Messages of doors by their kind, and requests. */
#include <errno.h>
#include <string.h>

#include "enroll/hub/answer/hub_answer.h"
#include "enroll/hub/answer/hub_sender.h"
#include "enroll/hub/people/hub_request.h"
#include "enroll/hub/store/hub_zone.h"

int hub__sender(struct hub_store *store, const void *bytes, size_t size, struct hub_door *out,
                struct iso_fault *fault)
{
    struct iso_fleet_id id;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    if (iso_fleet_door_of(bytes, size, &id)) {
        return iso_fault_set(fault, -EBADMSG, "a message names no door");
    }
    const int error = hub_door_get(store, &id, out, fault);
    if (error && error != -ENOENT) {
        return error;
    }
    const char *why = error             ? "is unknown"
                      : !out->joined_s  ? "has not joined"
                      : out->expelled_s ? "is expelled"
                                        : NULL;
    return why ? iso_fault_set(fault, -EACCES, "a message of door %s, which %s",
                               iso_fleet_id_text(&id, text), why)
               : 0;
}

int hub__sender_fault(const struct hub_door *door, const char *what, int error,
                      struct iso_fault *fault)
{
    return iso_fault_set(fault, error, "door %s: a %s %s", door->name, what,
                         error == -EKEYREJECTED      ? "was signed or sealed by somebody else"
                         : error == -EPROTONOSUPPORT ? "is of a newer version"
                         : error == -ENOMEM          ? "needs more memory than there is"
                                                     : "is damaged");
}

int hub_take(struct hub_store *store, const struct iso_fleet_id *door, const void *bytes,
             size_t size, const struct hub_emit *emit, struct iso_fault *fault)
{
    enum iso_fleet_kind kind;
    struct iso_fleet_id named;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    int error = iso_fleet_kind_of(bytes, size, &kind);
    if (error == -EPROTONOSUPPORT) {
        return iso_fault_set(fault, error,
                             "door %s: a message is of a newer version; upgrade the hub",
                             iso_fleet_id_text(door, text));
    }
    error = error ? error : iso_fleet_door_of(bytes, size, &named);
    if (error || !iso_fleet_id_is_same(&named, door)) {
        return iso_fault_set(fault, error ? error : -EBADMSG,
                             "door %s: a message is none of this door",
                             iso_fleet_id_text(door, text));
    }
    switch (kind) {
    case ISO_FLEET_QUESTION:
        return hub_take_question(store, bytes, size, emit, fault);
    case ISO_FLEET_EVENTS:
        return hub_take_events(store, bytes, size, emit, fault);
    case ISO_FLEET_REQUEST:
        return hub_take_request(store, bytes, size, fault);
    default:
        return iso_fault_set(fault, -EBADMSG, "door %s: a message of kind %d",
                             iso_fleet_id_text(door, text), (int)kind);
    }
}

/* Whether the door's home zone approves requests at once. */
static int is_auto(struct hub_store *store, const struct hub_door *door, bool *out,
                   struct iso_fault *fault)
{
    struct hub_zone home;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    if (door->n_zones == 0) {
        *out = false;
        return 0;
    }
    const int error = hub_zone_find(store, iso_fleet_id_text(&door->zones[0], text), &home, fault);
    if (!error) {
        *out = home.settings.approve_auto;
    }
    return error;
}

int hub_take_request(struct hub_store *store, const void *bytes, size_t size,
                     struct iso_fault *fault)
{
    struct hub_door door;
    struct iso_fleet_id named;
    struct iso_fleet_bytes body = {.bytes = NULL};
    struct iso_fleet_person person;
    bool at_once = false;
    int error = hub__sender(store, bytes, size, &door, fault);
    if (error) {
        return error;
    }
    error = iso_fleet_read_request(bytes, size, door.signs, &store->keys.receives, &named, &body,
                                   &person);
    if (error) {
        return hub__sender_fault(&door, "request", error, fault);
    }
    error = hub_request_add(store, &door.id, &person, fault);
    error = error ? error : is_auto(store, &door, &at_once, fault);
    const struct iso_fleet_id id = person.id;
    iso_fleet_bytes_free(&body);
    if (error || !at_once) {
        return error;
    }
    /* What prevents the approval now waits for a person: the name is taken, the zone is behind its
     * doors, or it was decided before. After a fault of the database the message is tried again. */
    error = hub_request_approve(store, &id, NULL, 0, fault);
    return error == -ENOTCONN || error == -EAGAIN || error == -ENOSPC || error == -EIO ||
                   error == -ENOMEM
               ? error
               : 0;
}

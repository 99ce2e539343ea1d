#include "tests/firmware/faults/storage_fleet.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/appliance/administration/administration.h"
#include "firmware/fleet/door/fleet_record.h"
#include "tests/firmware/fleet/door/door_rig.h"

enum { CARL = 110, DORA = 140 };

static struct door_rig hub;
static struct iso_fleet_bytes message; /* the change that comes */

static void prepare(struct storage_world *w)
{
    struct iso_transfer_keys keys;
    storage_prepare_two(w);
    hub = (struct door_rig){.directory = w->directory, .gallery = w->rig->gallery};
    iso_transfer_get_keys(w->rig->borrowed.ring, &keys);
    memcpy(hub.door_signs.public, keys.signs, sizeof keys.signs);
    memcpy(hub.door_receives.public, keys.receives, sizeof keys.receives);
    hub.fleet = iso_appliance_fleet(w->rig->appliance);
    door_rig_make_hub(&hub);
    door_rig_join(&hub);
    hub.local_people = true;
    door_rig_begin(&hub, 1);
    iso_fleet_bytes_free(&message);
}

void storage_prepare_put(struct storage_world *w)
{
    prepare(w);
    message = door_rig_put(&hub, 0, 1, 1, "carl", CARL, false);
}

void storage_prepare_remove(struct storage_world *w)
{
    prepare(w);
    assert_int_equal(door_rig_give(&hub, door_rig_put(&hub, 0, 2, 1, "dora", DORA, false)),
                     ISO_FLEET_APPLIED);
    message = door_rig_remove(&hub, 0, 2, 2);
}

void storage_prepare_hub_policy(struct storage_world *w)
{
    prepare(w);
    message = door_rig_policy(&hub, 0, "{\"access_points\": [{\"token\": \"front\"}]}");
}

int storage_hear(struct storage_world *w, struct iso_fault *fault)
{
    enum iso_fleet_outcome outcome = ISO_FLEET_REFUSED;
    struct iso_fleet_id zone;
    const int error = iso_fleet_receive(iso_appliance_fleet(w->rig->appliance), message.bytes,
                                        message.size, &outcome, &zone, fault);
    assert_true(error || outcome == ISO_FLEET_APPLIED);
    return error;
}

size_t storage_place(const struct iso_gallery *gallery, char *text, size_t size)
{
    struct iso__fleet_record record;
    size_t n = 0;
    const void *bytes = iso_gallery_access(gallery, ISO_GALLERY_FLEET, &n);
    if (!bytes) {
        return 0;
    }
    assert_int_equal(iso__fleet_record_get(bytes, n, &record), 0);
    return (size_t)snprintf(text, size, " place %llu",
                            (unsigned long long)record.zones[0].place.sequence);
}

#include "enroll/hub/outlet/run/hub_outlet_try.h"

#include <errno.h>
#include <stdio.h>
#include <time.h>

#include "enroll/hub/outlet/carry/carrier.h"

static const char record[] =
    "{\"event\":\"test\",\"note\":\"isotherm-hub asks whether this outlet works\"}";

static int hand(struct hub_store *store, const struct hub__outlet_row *row, struct iso_fault *fault)
{
    char time[32];
    struct tm utc;
    const time_t now = (time_t)store->now_s();
    const struct hub__batch_event event = {
        .door_name = store->hub_name, .time = time, .event = "test", .record = record};
    const struct hub__batch batch = {.key = iso_fleet_id_random(), .n = 1, .one = &event};
    struct hub__carrier *carrier = NULL;
    const int error = hub__carrier_new(row, store, -1, &carrier, fault);
    if (error) {
        return error;
    }
    (void)strftime(time, sizeof time, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    const struct hub__delivery delivery = hub__carrier_hand(carrier, &batch);
    hub__carrier_free(carrier);
    return delivery.outcome == HUB__TAKEN
               ? 0
               : iso_fault_set(fault, -EREMOTEIO, "%s: %s", row->outlet.name, delivery.why);
}

int hub_outlet_try(struct hub_store *store, const char *name, struct iso_fault *fault)
{
    struct hub__outlet_row row = {.ca = NULL};
    int error = hub__outlet_load(store, NULL, name, &row, fault);
    if (!error) {
        error = hand(store, &row, fault);
        hub__outlet_wipe(&row);
    }
    return error;
}

#include "tests/enroll/hub/outlet/webhook_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

struct receiver webhook_rig_receiver;

int webhook_rig_setup(void **state)
{
    (void)unlink(WEBHOOK_RIG_LOG);
    receiver_start(&webhook_rig_receiver, WEBHOOK_RIG_SECRET);
    return store_rig_setup(state);
}

int webhook_rig_teardown(void **state)
{
    receiver_stop(&webhook_rig_receiver);
    (void)unlink(WEBHOOK_RIG_LOG);
    return store_rig_teardown(state);
}

void webhook_rig_add(struct store_rig *rig, const char *events, bool from_beginning, const char *ca)
{
    struct iso_fault fault = {.text = ""};
    char address[64], out[HUB_OUTLET_SECRET_SIZE];
    (void)snprintf(address, sizeof address, "https://localhost:%u/events",
                   webhook_rig_receiver.port);
    const struct hub_outlet_options options = {.name = "siem",
                                               .address = address,
                                               .kind = HUB_OUTLET_WEBHOOK,
                                               .events = events,
                                               .secret = WEBHOOK_RIG_SECRET,
                                               .ca = ca,
                                               .from_beginning = from_beginning};
    store_rig_fine(hub_outlet_add(&rig->store, &options, out, &fault), &fault);
    assert_string_equal(out, WEBHOOK_RIG_SECRET);
}

static size_t door_of(struct arrivals *arrivals, const char *text)
{
    size_t i = 0;
    while (i < arrivals->n_doors && strcmp(arrivals->doors[i], text) != 0) {
        i++;
    }
    if (i == arrivals->n_doors) {
        assert_true(arrivals->n_doors < WEBHOOK_RIG_DOORS);
        (void)snprintf(arrivals->doors[arrivals->n_doors++], sizeof *arrivals->doors, "%s", text);
    }
    return i;
}

static bool is_repeated(size_t request)
{
    for (size_t i = 0; i < request; i++) {
        if (webhook_rig_receiver.requests[i].status == 200 &&
            strcmp(webhook_rig_receiver.requests[i].key,
                   webhook_rig_receiver.requests[request].key) == 0) {
            /* The same key means the same batch. */
            if (strcmp(webhook_rig_receiver.requests[i].body,
                       webhook_rig_receiver.requests[request].body) != 0) {
                fail_msg("two batches have the key %s", webhook_rig_receiver.requests[i].key);
            }
            return true;
        }
    }
    return false;
}

struct arrivals webhook_rig_arrivals(void)
{
    struct arrivals arrivals = {.n_doors = 0};
    for (size_t i = 0; i < webhook_rig_receiver.n; i++) {
        assert_true(webhook_rig_receiver.requests[i].is_genuine);
        if (webhook_rig_receiver.requests[i].status != 200) {
            continue;
        }
        if (is_repeated(i)) {
            arrivals.repeated_batches++;
            continue;
        }
        json_t *array = json_loads(webhook_rig_receiver.requests[i].body, 0, NULL);
        size_t k;
        json_t *event;
        assert_true(json_array_size(array) > 0);
        json_array_foreach(array, k, event)
        {
            const size_t door = door_of(&arrivals,
                                        json_string_value(json_object_get(event, "door")));
            const uint64_t number = (uint64_t)json_integer_value(json_object_get(event, "number"));
            if (number != arrivals.last[door] + 1) {
                fail_msg("%llu comes after %llu", (unsigned long long)number,
                         (unsigned long long)arrivals.last[door]);
            }
            arrivals.last[door] = number;
            arrivals.events++;
        }
        json_decref(array);
    }
    return arrivals;
}

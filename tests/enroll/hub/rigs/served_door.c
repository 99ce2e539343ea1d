#include "tests/enroll/hub/rigs/served_door.h"

#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/scratch.h"

struct hub_rig rig;
struct door_rig door;
static bool is_possible;

double served_now_s(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void served_ok(int error, const struct iso_fault *fault)
{
    if (error) {
        fail_msg("%d: %s", error, fault->text);
    }
}

int served_door_setup(void **state)
{
    assert_int_equal(scratch_setup(state), 0);
    is_possible = hub_rig_start(&rig, *state);
    if (!is_possible) {
        return 0;
    }
    hub_rig_serve(&rig, 0);
    (void)hub_rig_leader(&rig);
    door_rig_make(&door, *state);
    return 0;
}

int served_door_teardown(void **state)
{
    broker_client_end(&door.client);
    hub_rig_stop(&rig);
    return scratch_teardown(state);
}

void served_door_join(void)
{
    assert_int_equal(door_rig_join(&door, rig.hubs[0].port, hub_rig_add_door(&rig, "Gate")), 200);
    hub_rig_reload(&rig, door.id, true);
}

void served_door_connect(struct iso_fleet_lease *lease)
{
    served_door_join();
    assert_true(door_rig_connect(&door, &rig.zone));
    assert_true(door_rig_ask(&door, "{}", 0, lease, 10));
}

void served_door_begin(void)
{
    if (!is_possible) {
        skip();
    }
}

#include "tests/firmware/rigs/supervisor_rig.h"

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "tests/support/devices/manual_clock.h"

#define MS ISO_NS_PER_MS

struct supervisor_rig supervisor_rig;

int supervisor_rig_setup(void **state)
{
    const struct iso_sensor_supervisor_options options = {.silence_ns = 1000 * MS,
                                                          .retry_ns = 100 * MS,
                                                          .retry_max_ns = 700 * MS,
                                                          .pause_ns = 400 * MS,
                                                          .stale_ns = 300 * MS};
    const struct iso_sensor_source source = puppet_sensor_source(&supervisor_rig.sensor);
    (void)state;
    supervisor_rig.now_ns = 1000 * MS;
    supervisor_rig.sensor = (struct puppet_sensor){.clock = manual_clock(&supervisor_rig.now_ns)};
    iso_sensor_supervisor_init(&supervisor_rig.supervisor, &options, &source,
                               supervisor_rig.now_ns);
    return 0;
}

int supervisor_rig_teardown(void **state)
{
    (void)state;
    iso_sensor_supervisor_done(&supervisor_rig.supervisor);
    assert_int_equal(supervisor_rig.sensor.opened, supervisor_rig.sensor.closed);
    return 0;
}

enum iso_sensor_news supervisor_rig_look(void)
{
    const struct iso_frame *frame = NULL;
    return iso_sensor_supervisor_look(&supervisor_rig.supervisor, supervisor_rig.now_ns, &frame);
}

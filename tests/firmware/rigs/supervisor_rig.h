/* A supervisor with a sensor that does what the test wants, and with the clock of the test. One rig
 * at a time. */
#ifndef TESTS_FIRMWARE_RIGS_SUPERVISOR_RIG_H
#define TESTS_FIRMWARE_RIGS_SUPERVISOR_RIG_H

#include "firmware/sensor/sensor_supervisor.h"
#include "tests/firmware/rigs/puppets.h"

struct supervisor_rig {
    int64_t now_ns;
    struct puppet_sensor sensor;
    struct iso_sensor_supervisor supervisor;
};

extern struct supervisor_rig supervisor_rig;

/* For cmocka. The sensor is not open yet. teardown fails if it was not closed as often as opened.
 */
int supervisor_rig_setup(void **state);
int supervisor_rig_teardown(void **state);

/* One look, whose frame is not wanted. */
enum iso_sensor_news supervisor_rig_look(void);

#endif

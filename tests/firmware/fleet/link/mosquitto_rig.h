/* A real broker for one test: mosquitto in a directory of the test, on a port of its own. Failures
 * fail the running cmocka test. */
#ifndef TESTS_FLEET_LINK_MOSQUITTO_RIG_H
#define TESTS_FLEET_LINK_MOSQUITTO_RIG_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

struct mosquitto_rig {
    pid_t pid; /* 0: it does not run */
    uint16_t port;
    char directory[160];
};

/* Whether there is a broker on this machine; else prints a line, and the caller skips the test. */
bool mosquitto_rig_is_there(void);

/* A port of this machine that nobody uses. */
uint16_t mosquitto_rig_free_port(void);

/* Starts a broker, which keeps nothing on the disk. `tls`: the directory has ca.pem, server.pem and
 * server-key.pem, and clients need a certificate. */
void mosquitto_rig_start(struct mosquitto_rig *rig, const char *directory, bool tls);

/* Kills it; and starts it again on the same port. */
void mosquitto_rig_kill(struct mosquitto_rig *rig);
void mosquitto_rig_revive(struct mosquitto_rig *rig);

#endif

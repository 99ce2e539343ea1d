/* A scripted stand-in for the daemon in the process and on the event loop of the test, on a
 * connection of its own. It keeps to the signatures of firmware/contract/contract.h for the methods
 * that the web server calls. */
#ifndef TEST_WEB_RIG_SERVICE_H
#define TEST_WEB_RIG_SERVICE_H

#include <stdbool.h>
#include <stdint.h>
#include <systemd/sd-bus.h>
#include <systemd/sd-event.h>

struct rig_service {
    sd_bus *bus;      /* NULL: it is not on the bus */
    char trace[8192]; /* the calls except GetStatus and ReadLog: "Claim;EnrollStart bob poses=1;" */
    const char *fail_method, *fail_error; /* the method that fails, and its error; NULL: none */
    int fail_times;                       /* how often; 0: always */
    const char *silent_method;            /* the method that is not answered */

    uint64_t uptime_ms;
    const char *mode;
    bool lockdown;
    const char *remark; /* of RenamePerson; NULL: "" */
    int n_people;       /* "person 00000" and so on */
    int last_record;
    /* Writes record `number`; NULL: there are none. */
    void (*record)(int number, char *line, size_t size);
    int n_log_calls;

    char claimant[64];
    int outline_fd, relief_fd; /* the ends to which the test writes records; -1: none */
    int n_watches;
};

void rig_service_start(struct rig_service *service, sd_event *event, const char *address);

/* Leaves the bus. */
void rig_service_stop(struct rig_service *service);

/* Sends a signal to all, or to the client that has the claim. */
void rig_service_signal(struct rig_service *service, bool to_claimant, const char *member,
                        const char *types, ...);

/* The same signal from another client. */
void rig_strange_signal(const char *address, const char *destination, const char *member,
                        const char *types, ...);

#endif

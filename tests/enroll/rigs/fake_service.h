/* The inner parts of the scripted stand-in for the daemon: its state, and a handler for each
 * method. fake_daemon.c and the files of the methods share them. */
#ifndef TEST_FAKE_SERVICE_H
#define TEST_FAKE_SERVICE_H

#include <systemd/sd-bus.h>

#include "tests/enroll/rigs/fake_daemon.h"

struct fake_service {
    const struct fake_script *script;
    const char *address;
    int trace_fd;
    char claimed_by[64], action[16]; /* "": no claim, no action */
    bool leave;
    unsigned n_log_calls; /* number of the calls of ReadLog that were answered */
    unsigned n_refused;   /* number of the calls of ReadLog that failed, see refused */
};

/* Adds text to the calls that fake_daemon_stop returns. */
void fake_trace(const struct fake_service *service, const char *text);

/* Adds the options of a call, a{sv}, as " name=value". Returns 0 or a negative errno of sd-bus. */
int fake_trace_options(const struct fake_service *service, sd_bus_message *call);

/* Notes the call. If the script lets this method fail, answers it with the scripted error and
 * returns true. */
bool fake_fails(const struct fake_service *service, sd_bus_message *call, sd_bus_error *error);

/* Whether the caller has claimed the camera. If it has not, *error is set. */
bool fake_is_claimant(const struct fake_service *service, sd_bus_message *call,
                      sd_bus_error *error);

/* Opens a new connection. Returns 0 or a negative errno of sd-bus. */
int fake_open_bus(const char *address, sd_bus **bus);

/* Returns NULL if no person has this name. */
const struct fake_person *fake_find_person(const struct fake_service *service, const char *name);

/* The handlers of the methods of firmware/contract/contract.h. */
int fake_on_enroll_start(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_verify_start(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_identify_start(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_stop(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_claim(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_release(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_aim_start(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_aim_stop(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_picture(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_list(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_delete(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_set_validity(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_rename(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_get_site(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_list_look_alikes(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_list_other(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_take_back(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_get_settings(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_set_setting(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_reset_setting(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_get_policy(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_set_policy(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_check_policy(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_test_access(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_get_credential(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_set_credential(sd_bus_message *call, void *context, sd_bus_error *error);
int fake_on_read_log(sd_bus_message *call, void *context, sd_bus_error *error);

#endif

/* The API of the hub on a web server, with a real database behind it. Failures fail the running
 * cmocka test. */
#ifndef TESTS_ENROLL_HUB_RIGS_API_RIG_H
#define TESTS_ENROLL_HUB_RIGS_API_RIG_H

#include <jansson.h>

#include "enroll/hub/api/hub_api.h"
#include "tests/enroll/hub/rigs/played_door.h"
#include "tests/enroll/hub/rigs/store_rig.h"
#include "tests/enroll/web/rigs/web_rig.h"

#define API_RIG_PASSWORD "correct horse battery"

struct hub_api_rig {
    struct store_rig *hub;
    struct hub_store_options options;
    struct hub_api api;
    struct web_rig web;
    struct web_guess guess;
    struct https client;
    char accounts[256], setup_code[256];
    void *folder;         /* of scratch_setup */
    char headers[4][512]; /* of requests with a session, by role */
};

extern struct hub_api_rig api_rig;

/* cmocka set-up and tear-down of each test; the group has store_rig_start and store_rig_stop. */
int api_rig_setup(void **state);
int api_rig_teardown(void **state);

/* Asks as an account "none" (without a session), "observer", "enroller" or "administrator", and
 * returns the answer, which the caller releases; NULL for 204. `body` has ' in place of ". */
json_t *api_rig_ask(enum web_role role, const char *method, const char *path, const char *body,
                    int status);

/* The same as an administrator, and releases the answer. */
void api_rig_do(const char *method, const char *path, const char *body, int status);

/* Asks, and expects a problem with this code. */
void api_rig_refused(enum web_role role, const char *method, const char *path, const char *body,
                     int status, const char *code);

/* Expects the newest act: "ACCOUNT ACT OBJECT". It may come a little later. */
void api_rig_expect_act(const char *wanted);

/* Adds a door of the zone "house" by the API, and lets it join with the code of its address. */
void api_rig_join(struct played_door *door, const char *name);

/* The door asks the hub, fetches what it lacks, and confirms. */
void api_rig_ask_hub(struct played_door *door);

/* A text or number of an answer by a path such as "zones.0.name". It fails if there is none. */
const char *api_rig_text(const json_t *json, const char *path);
int64_t api_rig_number(const json_t *json, const char *path);
const json_t *api_rig_at(const json_t *json, const char *path);

#endif

/* An identity provider for tests: asks the running hub over HTTPS. Failures fail the running cmocka
 * test. */
#ifndef TESTS_ENROLL_HUB_SERVE_SCIM_RIG_H
#define TESTS_ENROLL_HUB_SERVE_SCIM_RIG_H

#include <jansson.h>

#include "enroll/hub/scim/hub_scim.h"
#include "tests/enroll/hub/rigs/served_door.h"

#define SCIM_CORE_USER  "urn:ietf:params:scim:schemas:core:2.0:User"
#define SCIM_PATCH      "{'schemas':['urn:ietf:params:scim:api:messages:2.0:PatchOp'],'Operations':"
#define SCIM_TEST(test) cmocka_unit_test_setup_teardown(test, scim_rig_setup, scim_rig_teardown)

extern char scim_token[HUB_SCIM_TOKEN_SIZE]; /* with which it asks; "": none */
extern char scim_headers[2048];              /* of the last answer */

/* cmocka set-up and tear-down: a hub with the zones "Office" and "Lab", and the token "entra". */
int scim_rig_setup(void **state);
int scim_rig_teardown(void **state);

/* Asks; `body` has ' in place of ", and may be NULL; `header` is a further one, or NULL. Returns
 * the status; *json (NULL: not wanted) is the answer, which the caller releases. */
long scim_ask(const char *method, const char *path, const char *body, const char *header,
              json_t **json);

/* Asks, expects the status, and releases the answer. */
void scim_do(const char *method, const char *path, const char *body, long status);

/* Makes a resource and returns its path ("Users/ID") in one of several static buffers. */
const char *scim_make(const char *list, const char *body);

/* Makes the user "ada@example.org", Ada Lovelace. */
const char *scim_ada(void);

/* Adds a member to a group as Entra ID does. */
void scim_add_member(const char *group, const char *user);

bool scim_has(const char *text, const char *part);

/* The value of a member of a resource, as text; "" if there is none. A static buffer. */
const char *scim_text(const char *path, const char *member);

/* Enrols somebody of this name at a door, and approves it; the leader links it later, or mend does
 * at once. */
struct iso_fleet_id scim_enrol(const char *name, bool mend);

/* The names of the person's zones, joined by blanks. A static buffer. */
const char *scim_zones(const struct iso_fleet_id *person);

/* A number from a statement. */
int64_t scim_number(const char *sql);

/* Gives a zone to a group. */
void scim_map(const char *group, const char *zone);

#endif

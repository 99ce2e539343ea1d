/* The web server with the routes of updates, an administrator who is logged in, and the folders
 * that an image has. RAUC is what the test puts on the bus. */
#ifndef TESTS_ENROLL_WEB_UPDATE_RIG_H
#define TESTS_ENROLL_WEB_UPDATE_RIG_H

#include "enroll/web/update/update.h"
#include "tests/enroll/web/rigs/api_rig.h"
#include "tests/support/programs/private_bus.h"

#define UPDATE_RIG_BYTES "Content-Type: application/octet-stream\r\n"
#define UPDATE_RIG_PATH  "/api/v1/update"

struct update_rig {
    struct private_bus bus; /* main() starts and stops it */
    char folder[256], os_release[256];
    /* Header lines of the account that is logged in: its cookie alone; and with the origin and the
     * type of a bundle, or of JSON. */
    char cookie[256], bytes_head[512], json_head[512];
};

extern struct update_rig update_rig;

/* cmocka set-up and tear-down. *state is the folder of scratch_setup. */
int update_rig_setup(void **state);
int update_rig_teardown(void **state);

/* Begins a session of this role, which the header lines then have. `id` may be NULL. */
void update_rig_log_in(enum web_role role, uint64_t *id);

/* The path of a file in the folder of the web server. */
const char *update_rig_page(const char *name);

/* Checks that there is no bundle, neither whole nor in part. */
void update_rig_expect_nothing(void);

/* The state as the pages see it, which the caller releases; and a text of it, "" if there is none.
 */
json_t *update_rig_look(void);
const char *update_rig_word(const json_t *state, const char *member);

/* Sends the head of a request for a bundle of `size` bytes on a connection of its own. */
void update_rig_announce(struct https *client, size_t size);

/* Reads the answer and closes the connection. Fails unless the answer has this status and this code
 * of a problem ("": it has none). */
void update_rig_expect_answer(struct https *client, int status, const char *code);

#endif

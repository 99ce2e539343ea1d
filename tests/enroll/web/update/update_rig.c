#include "tests/enroll/web/update/update_rig.h"

#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/scratch.h"

struct update_rig update_rig;

void update_rig_log_in(enum web_role role, uint64_t *id)
{
    const char *headers = web_rig_login(&api_rig.web, "ada", role, id);

    (void)snprintf(update_rig.cookie, sizeof update_rig.cookie, "%s", strstr(headers, "Cookie:"));
    (void)snprintf(update_rig.bytes_head, sizeof update_rig.bytes_head,
                   WEB_RIG_ORIGIN UPDATE_RIG_BYTES "%s", update_rig.cookie);
    (void)snprintf(update_rig.json_head, sizeof update_rig.json_head, "%s", headers);
}

const char *update_rig_page(const char *name)
{
    return scratch_path(scratch_path(update_rig.folder, "page"), name);
}

int update_rig_setup(void **state)
{
    web_rig_intakes = web_api_intakes;
    assert_int_equal(api_rig_setup(state), 0);
    (void)snprintf(update_rig.folder, sizeof update_rig.folder, "%s",
                   scratch_path(*state, "updates"));
    scratch_mkdir(update_rig.folder);
    scratch_mkdir(update_rig_page(""));
    scratch_write_text(scratch_path(update_rig.folder, "os-release"),
                       "IMAGE_ID=isotherm-test\nIMAGE_VERSION=\"1.0.0\"\n");
    (void)snprintf(update_rig.os_release, sizeof update_rig.os_release, "%s",
                   scratch_path(update_rig.folder, "os-release"));
    const struct web_update_setup update = {.event = api_rig.web.event,
                                            .bus = update_rig.bus.address,
                                            .folder = update_rig.folder,
                                            .os_release = update_rig.os_release};
    assert_int_equal(web_update_new(&update, &api_rig.api.update), 0);
    update_rig_log_in(WEB_ROLE_ADMINISTRATOR, NULL);
    return 0;
}

/* The server ends before the update, because a bundle may still come. */
int update_rig_teardown(void **state)
{
    struct web_update *update = api_rig.api.update;

    web_update_close(update);
    const int r = api_rig_teardown(state);
    web_update_free(update);
    return r;
}

void update_rig_expect_nothing(void)
{
    assert_false(scratch_exists(update_rig_page("bundle.part")));
    assert_false(scratch_exists(update_rig_page("bundle.raucb")));
}

json_t *update_rig_look(void)
{
    struct https_answer answer;

    https_ask(&api_rig.client, "GET", UPDATE_RIG_PATH, update_rig.json_head, NULL, &answer);
    assert_int_equal(answer.status, 200);
    json_t *state = json_loads(answer.body, 0, NULL);
    assert_non_null(state);
    https_answer_free(&answer);
    return state;
}

const char *update_rig_word(const json_t *state, const char *member)
{
    const char *text = json_string_value(json_object_get(state, member));

    return text ? text : "";
}

void update_rig_announce(struct https *client, size_t size)
{
    char head[1024];

    web_rig_connect(&api_rig.web, client);
    (void)snprintf(head, sizeof head,
                   "POST " UPDATE_RIG_PATH
                   " HTTP/1.1\r\nHost: door.test\r\n%sContent-Length: %zu\r\n\r\n",
                   update_rig.bytes_head, size);
    https_send(client, head);
}

void update_rig_expect_answer(struct https *client, int status, const char *code)
{
    struct https_answer answer;

    https_read(client, &answer);
    if (answer.status != status) {
        fail_msg("%d instead of %d: %s", answer.status, status, answer.body);
    }
    json_t *json = json_loads(answer.body, 0, NULL);
    assert_string_equal(update_rig_word(json, "code"), code);
    json_decref(json);
    https_answer_free(&answer);
    https_close(client);
}

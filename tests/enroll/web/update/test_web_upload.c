/* A bundle that comes by the API, over HTTPS: who may bring one, what is refused before a byte is
 * kept, and what becomes of it. */
#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mount.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/web/update/update_rig.h"
#include "tests/support/scratch.h"

extern void __asan_init(void) __attribute__((weak));

static void pump_until(bool (*holds)(const struct web_upload *upload), bool value)
{
    for (int i = 0; i < 3000 && holds(web_update_upload(api_rig.api.update)) != value; i++) {
        https_pump(api_rig.web.event, -1);
    }
    assert_int_equal(holds(web_update_upload(api_rig.api.update)), value);
}

/* ---- who may ---- */

static void only_administrators_may(void **state)
{
    (void)state;
    api_rig_expect("POST", UPDATE_RIG_PATH, WEB_RIG_ORIGIN UPDATE_RIG_BYTES, "bundle", 401,
                   "login-required");
    api_rig_expect("GET", UPDATE_RIG_PATH, WEB_RIG_ORIGIN, NULL, 401, "login-required");
    for (enum web_role role = WEB_ROLE_OBSERVER; role < WEB_ROLE_ADMINISTRATOR; role++) {
        update_rig_log_in(role, NULL);
        api_rig_expect("POST", UPDATE_RIG_PATH, update_rig.bytes_head, "bundle", 403,
                       "not-allowed");
        api_rig_expect("GET", UPDATE_RIG_PATH, update_rig.json_head, NULL, 403, "not-allowed");
        api_rig_expect("POST", UPDATE_RIG_PATH "/restart", update_rig.json_head, "{}", 403,
                       "not-allowed");
    }
    assert_string_equal(api_rig.said, "");
    update_rig_expect_nothing();
}

static void other_pages_may_not(void **state)
{
    char headers[512];
    (void)state;

    (void)snprintf(headers, sizeof headers,
                   "Origin: https://elsewhere.test\r\n" UPDATE_RIG_BYTES "%s", update_rig.cookie);
    api_rig_expect("POST", UPDATE_RIG_PATH, headers, "bundle", 403, "other-origin");
    (void)snprintf(headers, sizeof headers, UPDATE_RIG_BYTES "%s", update_rig.cookie);
    api_rig_expect("POST", UPDATE_RIG_PATH, headers, "bundle", 403, "other-origin");
    update_rig_expect_nothing();
}

static void what_is_no_bundle_is_refused(void **state)
{
    struct https client;
    char head[1024];
    (void)state;

    api_rig_expect("POST", UPDATE_RIG_PATH, update_rig.json_head, "{}", 415, "other-type");
    api_rig_expect("POST", UPDATE_RIG_PATH, update_rig.bytes_head, NULL, 411, "no-length");
    web_rig_connect(&api_rig.web, &client);
    (void)snprintf(head, sizeof head,
                   "POST " UPDATE_RIG_PATH " HTTP/1.1\r\nHost: door.test\r\n%s"
                   "Transfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n",
                   update_rig.bytes_head);
    https_send(&client, head);
    update_rig_expect_answer(&client, 411, "no-length");
    update_rig_announce(&client, WEB_UPLOAD_MOST_BYTES + 1);
    update_rig_expect_answer(&client, 413, "too-large");
    update_rig_expect_nothing();
    assert_string_equal(api_rig.said, "");
}

/* ---- a bundle ---- */

static void a_bundle_is_handed_over(void **state)
{
    enum { SIZE = 16 << 20 };
    char *bundle = malloc(SIZE + 1);
    struct https client, other;
    size_t size;
    (void)state;

    assert_non_null(bundle);
    for (size_t i = 0; i < SIZE; i++) {
        bundle[i] = (char)('a' + i * i % 23);
    }
    bundle[SIZE] = '\0';
    const long before_kb = web_rig_resident_kb();
    update_rig_announce(&client, SIZE);
    pump_until(web_upload_is_coming, true);
    update_rig_announce(&other, 5);
    update_rig_expect_answer(&other, 409, "update-running");
    https_send(&client, bundle);
    update_rig_expect_answer(&client, 202, "");
    if (!__asan_init) { /* it was not kept in memory; the sanitizer keeps all for a while */
        assert_true(web_rig_resident_kb() - before_kb < SIZE / 1024 / 2);
    }
    assert_string_equal(api_rig.said, "ada update \n");
    char *kept = scratch_read(update_rig_page("bundle.raucb"), &size);
    assert_int_equal(size, SIZE);
    assert_memory_equal(kept, bundle, SIZE);
    free(kept);
    free(bundle);

    /* Until the unit has done with it, there is no other one. */
    update_rig_announce(&client, 5);
    update_rig_expect_answer(&client, 409, "update-running");
    json_t *seen = update_rig_look();
    assert_true(json_is_true(json_object_get(seen, "handed_over")));
    json_decref(seen);
    const char *taken = scratch_path(update_rig.folder, "page.raucb");
    assert_int_equal(rename(update_rig_page("bundle.raucb"), taken), 0);
    update_rig_announce(&client, 5);
    update_rig_expect_answer(&client, 409, "update-running");
    assert_int_equal(unlink(taken), 0);
    update_rig_announce(&client, 5);
    https_send(&client, "fresh");
    update_rig_expect_answer(&client, 202, "");
}

static void a_client_that_goes_away_leaves_nothing(void **state)
{
    struct https client;
    (void)state;

    update_rig_announce(&client, 1000);
    https_send(&client, "the beginning");
    pump_until(web_upload_is_coming, true);
    assert_true(scratch_exists(update_rig_page("bundle.part")));
    https_close(&client);
    pump_until(web_upload_is_coming, false);
    update_rig_expect_nothing();
    assert_string_equal(api_rig.said, "");
}

static void without_a_record_nothing_is_installed(void **state)
{
    const sd_bus_error gone = SD_BUS_ERROR_MAKE_CONST(SD_BUS_ERROR_NO_REPLY, "no reply");
    struct https client;
    (void)state;

    api_rig.error = &gone;
    update_rig_announce(&client, 6);
    https_send(&client, "bundle");
    update_rig_expect_answer(&client, 503, "no-daemon");
    update_rig_expect_nothing();
    assert_false(web_upload_is_coming(web_update_upload(api_rig.api.update)));
}

static void a_session_that_ends_meanwhile_installs_nothing(void **state)
{
    struct https client;
    uint64_t session;
    (void)state;

    update_rig_log_in(WEB_ROLE_ADMINISTRATOR, &session);
    api_rig.waits = true;
    update_rig_announce(&client, 6);
    https_send(&client, "bundle");
    for (int i = 0; i < 3000 && !api_rig.on_reply; i++) {
        https_pump(api_rig.web.event, -1);
    }
    assert_non_null(api_rig.on_reply);
    web_session_end_account(&api_rig.web.sessions, "ada", 0);
    (void)api_rig_reply(NULL, NULL);
    update_rig_expect_answer(&client, 401, "login-required");
    update_rig_expect_nothing();
}

/* The disk is a file system in memory with less room than stays reserved, or hardly more. */
static void a_full_disk_is_said_before(void **state)
{
    struct https client;
    (void)state;

    if (geteuid() != 0 || unshare(CLONE_NEWNS) < 0 ||
        mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) < 0) {
        print_message("skipped: needs the rights to mount\n");
        skip();
    }
    assert_int_equal(mount("none", update_rig_page(""), "tmpfs", 0, "size=65M"), 0);
    update_rig_announce(&client, 2 << 20);
    update_rig_expect_answer(&client, 507, "no-room");
    update_rig_expect_nothing();
    json_t *seen = update_rig_look();
    const json_int_t most = json_integer_value(json_object_get(seen, "most_bytes"));
    assert_in_range(most, 1, 1 << 20);
    json_decref(seen);
    assert_int_equal(umount(update_rig_page("")), 0);
}

int main(void)
{
#define ON_RIG(test) cmocka_unit_test_setup_teardown(test, update_rig_setup, update_rig_teardown)
    const struct CMUnitTest tests[] = {
        ON_RIG(only_administrators_may),
        ON_RIG(other_pages_may_not),
        ON_RIG(what_is_no_bundle_is_refused),
        ON_RIG(a_bundle_is_handed_over),
        ON_RIG(a_client_that_goes_away_leaves_nothing),
        ON_RIG(without_a_record_nothing_is_installed),
        ON_RIG(a_session_that_ends_meanwhile_installs_nothing),
        ON_RIG(a_full_disk_is_said_before),
    };

    if (!private_bus_start(&update_rig.bus)) {
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&update_rig.bus);
    return failed;
}

/* The methods Watch and WatchRelief: who gets a stream, what its records say, and when it ends. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "firmware/contract/stream_record.h"
#include "tests/firmware/rigs/bus_rig.h"

/* Calls Watch (with a word) or WatchRelief. Returns the stream, or -1 with the error's name. */
static int watch(struct bus_rig *f, int client, const char *what, const char **error)
{
    int fd = -1;
    sd_bus_message *call = bus_rig_new_call(f, client,
                                            what ? ISO_CONTRACT_WATCH : ISO_CONTRACT_WATCH_RELIEF);
    assert_true(!what || sd_bus_message_append(call, "s", what) >= 0);
    struct bus_answer *answer = bus_rig_send(f, client, call);
    if (error) {
        *error = *answer->error ? strrchr(answer->error, '.') + 1 : "";
    }
    if (*answer->error) {
        return -1;
    }
    assert_true(sd_bus_message_read(answer->reply, "h", &fd) > 0);
    return fcntl(fd, F_DUPFD_CLOEXEC, 3);
}

/* Reads until the last record. Returns how many there were, and leaves the last one in `out`. */
static int read_outlines(int fd, struct iso_outline_record *out)
{
    uint8_t bytes[ISO_STREAM_BYTES_MAX];
    int n = 0;
    ssize_t size;
    while ((size = recv(fd, bytes, sizeof bytes, 0)) > 0) {
        assert_int_equal(iso_outline_record_read(bytes, (size_t)size, out), 0);
        n++;
    }
    return n;
}

static bool has_ended(int fd)
{
    uint8_t byte;
    return recv(fd, &byte, 1, 0) == 0;
}

static void an_outline_says_what_happens_at_the_door(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct iso_outline_record record;
    const int fd = watch(f, 0, ISO_CONTRACT_WATCH_OUTLINE, NULL);
    rig_enrol(f->rig, "anna", 50);
    rig_show(f->rig, 50, 1);
    bus_rig_run(f, 40);
    assert_true(read_outlines(fd, &record) > 0);
    assert_string_equal(record.mode, "watch");
    assert_string_equal(record.verdict, "");
    assert_int_equal(record.distance_mm, 700);
    const uint32_t before = record.head.sequence;
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 200);
    const int n = read_outlines(fd, &record);
    assert_int_equal(record.head.sequence, before + (uint32_t)n);
    assert_string_equal(record.verdict, "allow");
    assert_string_equal(record.reason, "match");
    assert_string_equal(record.hint, "ok");
    bus_rig_run(f, 10000);
    (void)read_outlines(fd, &record);
    rig_show_unusable(f->rig, ISO_CAPTURE_TOO_FAR, 4);
    bus_rig_run(f, 300);
    assert_true(read_outlines(fd, &record) > 0);
    assert_string_equal(record.verdict, "");
    assert_string_equal(record.hint, iso_capture_name(ISO_CAPTURE_TOO_FAR));
    (void)close(fd);
}

static void a_refusal_has_its_reason(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct iso_outline_record record;
    const int fd = watch(f, 0, ISO_CONTRACT_WATCH_OUTLINE, NULL);
    rig_enrol(f->rig, "anna", 50);
    rig_show(f->rig, 90, 6);
    for (int i = 0; i < 10; i++) { /* a client that reads late does not get the last records */
        bus_rig_run(f, 30);
        (void)read_outlines(fd, &record);
    }
    assert_string_equal(record.verdict, "deny");
    assert_string_equal(record.reason, "unknown");
    assert_int_equal(iso_appliance_lockdown(f->rig->appliance, true, NULL), 0);
    rig_show(f->rig, 50, 1);
    bus_rig_run(f, 100);
    assert_true(read_outlines(fd, &record) > 0);
    assert_true(record.lockdown);
    assert_false(record.locked_out);
    (void)close(fd);
}

static void a_frame_costs_nothing_when_nobody_watches(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct iso_outline_record record;
    const int first = watch(f, 0, ISO_CONTRACT_WATCH_OUTLINE, NULL);
    (void)close(first);
    /* The answer of the first call, which has the stream, too, lasts until the next call. */
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_GET_STATUS, NULL), "");
    rig_show(f->rig, 50, 5); /* the first of these notices that nobody is left */
    bus_rig_run(f, 300);
    const int second = watch(f, 0, ISO_CONTRACT_WATCH_OUTLINE, NULL);
    rig_show(f->rig, 50, 1);
    bus_rig_run(f, 100);
    assert_int_equal(read_outlines(second, &record), 1);
    assert_int_equal(record.head.sequence, 2); /* the frames between were not counted */
    (void)close(second);
}

static void the_relief_needs_the_claim_and_ends_with_it(void **state)
{
    static struct iso_relief_record record;
    struct bus_rig *f = bus_rig_need(state);
    uint8_t bytes[ISO_STREAM_BYTES_MAX];
    const char *error = NULL;
    assert_int_equal(watch(f, 0, NULL, &error), -1);
    assert_string_equal(error, "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
    assert_int_equal(watch(f, 0, NULL, &error), -1);
    assert_string_equal(error, "AlreadyInUse");
    const int outline = watch(f, 0, ISO_CONTRACT_WATCH_OUTLINE, NULL);
    const int fd = watch(f, 1, NULL, NULL);
    assert_true(fd >= 0 && outline >= 0);
    assert_non_null(rig_record(f->rig, "relief"));
    rig_show(f->rig, 50, 1); /* no action goes on: the frames come all the same */
    bus_rig_run(f, 100);
    const ssize_t size = recv(fd, bytes, sizeof bytes, 0);
    assert_true(size > 0);
    assert_int_equal(iso_relief_record_read(bytes, (size_t)size, &record), 0);
    assert_int_equal(record.columns, 8);
    assert_int_equal(record.rows, 1);
    assert_int_equal(record.depth_mm[0], 150); /* the first pixel of the rig's face 50 */
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_RELEASE, NULL), "");
    assert_true(has_ended(fd));
    struct iso_outline_record rest;
    assert_int_equal(read_outlines(outline, &rest), 1);
    assert_string_equal(rest.mode, "claimed");
    assert_false(has_ended(outline));
    (void)close(fd);
    (void)close(outline);
}

static void the_relief_ends_when_its_client_leaves_the_bus(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    const int fd = watch(f, 0, NULL, NULL);
    sd_bus_flush_close_unref(f->client[0]);
    f->client[0] = NULL;
    for (int i = 0; i < BUS_RIG_ROUNDS && !has_ended(fd); i++) {
        bus_rig_go_round(f);
    }
    assert_true(has_ended(fd));
    (void)close(fd);
    f->client[0] = bus_rig_connect(f->told[0]);
}

static void bad_calls_are_refused(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const char *error = NULL;
    int fds[4];
    assert_int_equal(watch(f, 0, "pixels", &error), -1);
    assert_string_equal(error, "InvalidArgs");
    assert_int_equal(watch(f, 0, "", &error), -1);
    for (int i = 0; i < 4; i++) {
        fds[i] = watch(f, i % 2, ISO_CONTRACT_WATCH_OUTLINE, NULL);
        assert_true(fds[i] >= 0);
    }
    /* Both clients are of one user. */
    assert_int_equal(watch(f, 1, ISO_CONTRACT_WATCH_OUTLINE, &error), -1);
    assert_string_not_equal(error, "");
    for (int i = 0; i < 4; i++) {
        (void)close(fds[i]);
    }
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(an_outline_says_what_happens_at_the_door),
        TEST(a_refusal_has_its_reason),
        TEST(a_frame_costs_nothing_when_nobody_watches),
        TEST(the_relief_needs_the_claim_and_ends_with_it),
        TEST(the_relief_ends_when_its_client_leaves_the_bus),
        TEST(bad_calls_are_refused),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}

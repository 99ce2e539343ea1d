/* The service on a private bus: the progress of a long call. */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

enum { PEOPLE = 100, RECORDS = 200, STEP_MS = 20, SIGNAL_STEPS = 500 / STEP_MS };

/* The Progress signals that a client received. */
struct heard {
    int n;
    uint64_t done, total; /* of the last signal */
};

static int on_progress(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct heard *heard = context;
    uint64_t done, total;
    (void)error;
    assert_true(sd_bus_message_has_signature(signal, "tt"));
    assert_true(sd_bus_message_read(signal, "tt", &done, &total) > 0);
    assert_true(total > 0 && done <= total);
    assert_true(done >= heard->done);
    assert_true(heard->n == 0 || total <= heard->total);
    *heard = (struct heard){heard->n + 1, done, total};
    return 0;
}

static void hear(struct bus_rig *f, int client, struct heard *heard)
{
    *heard = (struct heard){0};
    assert_true(sd_bus_match_signal(f->client[client], NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                    ISO_CONTRACT_INTERFACE, ISO_CONTRACT_PROGRESS, on_progress,
                                    heard) >= 0);
}

/* A clock that advances by the same time at each reading. */
static int64_t slow_now_ns(void *context)
{
    return *(int64_t *)context += STEP_MS * ISO_NS_PER_MS;
}

static int64_t quick_now_ns(void *context)
{
    return *(int64_t *)context += 10 * 1000;
}

static void set_clock(struct bus_rig *f, int64_t (*now_ns)(void *context))
{
    f->rig->borrowed.times.monotonic = (struct iso_clock){now_ns, &f->rig->now_ns};
}

static void enrol_many(struct bus_rig *f)
{
    char name[16];
    for (int i = 0; i < PEOPLE; i++) {
        (void)snprintf(name, sizeof name, "person %d", i);
        rig_enrol(f->rig, name, 10 * i);
    }
}

/* ---- the calls ---- */

static void rotate(struct bus_rig *f)
{
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_ROTATE_KEYS, NULL), "");
}

static void verify_log(struct bus_rig *f)
{
    int sound = 0;
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_VERIFY_LOG);
    assert_true(sd_bus_message_append(call, "ts", UINT64_C(0), "") >= 0);
    struct bus_answer *answer = bus_rig_send(f, 0, call);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_read(answer->reply, "b", &sound) > 0);
    assert_true(sound);
}

static void append_bytes(sd_bus_message *call, const char *name, size_t size)
{
    static const uint8_t bytes[32] = {7};
    assert_true(sd_bus_message_open_container(call, 'e', "sv") >= 0);
    assert_true(sd_bus_message_append(call, "s", name) >= 0);
    assert_true(sd_bus_message_open_container(call, 'v', "ay") >= 0);
    assert_true(sd_bus_message_append_array(call, 'y', bytes, size) >= 0);
    assert_true(sd_bus_message_close_container(call) >= 0);
    assert_true(sd_bus_message_close_container(call) >= 0);
}

static void export(struct bus_rig *f, int fd)
{
    uint32_t n = 0;
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_EXPORT_PEOPLE);
    assert_true(sd_bus_message_append(call, "has", fd, 0) >= 0);
    assert_true(sd_bus_message_open_container(call, 'a', "{sv}") >= 0);
    append_bytes(call, ISO_CONTRACT_KEY, 32);
    append_bytes(call, ISO_CONTRACT_SALT, 16);
    assert_true(sd_bus_message_close_container(call) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 0, call);
    assert_string_equal(answer->text, "");
    assert_true(sd_bus_message_read(answer->reply, "u", &n) > 0);
    assert_int_equal(n, PEOPLE);
}

static void import(struct bus_rig *f, int fd, bool replace, uint32_t wanted)
{
    uint32_t added = 0, known = 0;
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_IMPORT_PEOPLE);
    assert_true(sd_bus_message_append(call, "h", fd) >= 0);
    assert_true(sd_bus_message_open_container(call, 'a', "{sv}") >= 0);
    append_bytes(call, ISO_CONTRACT_KEY, 32);
    assert_true(sd_bus_message_append(call, "{sv}", ISO_CONTRACT_REPLACE, "b", replace) >= 0);
    assert_true(sd_bus_message_close_container(call) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 0, call);
    assert_string_equal(answer->text, "");
    assert_true(sd_bus_message_read(answer->reply, "uu", &added, &known) > 0);
    assert_int_equal(added, wanted);
    assert_int_equal(known, PEOPLE - wanted);
}

/* ---- the tests ---- */

/* Expects one signal each half second of a call that takes so many steps. The last signal is near
 * the end. */
static void expect(const struct heard *heard, uint64_t steps, uint64_t total)
{
    assert_int_equal(heard->total, total);
    assert_in_range(heard->done, total - SIGNAL_STEPS, total);
    assert_in_range(heard->n, steps / SIGNAL_STEPS - 1, steps / SIGNAL_STEPS + 1);
}

static void reports_the_progress_of_a_rotation(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct heard caller, other;
    enrol_many(f);
    hear(f, 0, &caller);
    hear(f, 1, &other);
    set_clock(f, slow_now_ns);
    rotate(f);
    expect(&caller, 2 * PEOPLE, 2 * PEOPLE); /* each has a record and one template */
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_GET_STATUS, NULL), "");
    assert_int_equal(other.n, 0);
}

static void reports_the_progress_of_a_verification_of_the_log(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const struct iso_audit_record record = iso_audit_record_of("test");
    struct heard caller;
    for (int i = 0; i < RECORDS; i++) {
        assert_int_equal(iso_audit_append(f->rig->audit, &record, NULL), 0);
    }
    hear(f, 0, &caller);
    set_clock(f, slow_now_ns);
    verify_log(f);
    const uint64_t total = iso_audit_last(f->rig->audit) - iso_audit_first(f->rig->audit) + 1;
    assert_true(total >= RECORDS);
    expect(&caller, total, total);
}

static void reports_the_progress_of_export_and_import(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct heard caller;
    enrol_many(f);
    const int fd = memfd_create("people", MFD_CLOEXEC);
    assert_true(fd >= 0);
    hear(f, 0, &caller);
    set_clock(f, slow_now_ns);
    export(f, fd);
    expect(&caller, PEOPLE, PEOPLE);
    caller = (struct heard){0};
    import(f, fd, false, 0);
    assert_int_equal(caller.n, 0); /* all are known: there is nothing to do */
    import(f, fd, true, PEOPLE);   /* all are replaced, and read back */
    expect(&caller, 2 * PEOPLE, 2 * PEOPLE);
    for (int i = 0; i < PEOPLE; i += 2) {
        char name[16];
        (void)snprintf(name, sizeof name, "person %d", i);
        assert_int_equal(iso_gallery_remove(f->rig->gallery, name, NULL), 0);
    }
    caller = (struct heard){0};
    import(f, fd, false, PEOPLE / 2); /* each is prepared, and stored */
    expect(&caller, PEOPLE, PEOPLE);
    assert_int_equal(close(fd), 0);
}

static void reports_no_progress_of_a_short_call(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct heard caller;
    enrol_many(f);
    const int fd = memfd_create("people", MFD_CLOEXEC);
    assert_true(fd >= 0);
    hear(f, 0, &caller);
    set_clock(f, quick_now_ns);
    export(f, fd);
    import(f, fd, false, 0);
    rotate(f);
    verify_log(f);
    assert_int_equal(caller.n, 0);
    assert_int_equal(close(fd), 0);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(reports_the_progress_of_a_rotation),
        TEST(reports_the_progress_of_a_verification_of_the_log),
        TEST(reports_the_progress_of_export_and_import),
        TEST(reports_no_progress_of_a_short_call),
    };
    rig_capacity = PEOPLE;
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}

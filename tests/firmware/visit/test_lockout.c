/* The lock-out alone: counting, locking, forgetting, and its state after a restart. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/visit/lockout_file.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/scratch.h"

#define S ISO_NS_PER_S

enum { AGREE = 2 };

static const struct iso_lockout_options options = {
    .failures = 3, .attacks = 2, .first_ns = 10 * S, .longest_ns = 50 * S, .forget_ns = 100 * S};

static struct iso_lockout lockout;

static int setup(void **state)
{
    iso_lockout_init(&lockout, &options);
    return stores_setup(state);
}

static bool verdict(enum iso_reason reason, int frames, int64_t t_s)
{
    const struct iso_verdict v = {
        .allow = reason == ISO_REASON_MATCH, .reason = reason, .frames = frames};
    (void)iso_lockout_time(&lockout, t_s * S);
    return iso_lockout_verdict(&lockout, &v, AGREE, t_s * S);
}

static bool fails(int64_t t_s)
{
    return verdict(ISO_REASON_UNKNOWN, 6, t_s);
}

static void expect(enum iso_reason refusal, int64_t remaining_s, int64_t t_s)
{
    assert_int_equal(iso_lockout_refusal(&lockout), refusal);
    assert_int_equal(iso_lockout_remaining_ns(&lockout, t_s * S), remaining_s * S);
}

static void locks_after_failures_in_a_row(void **state)
{
    (void)state;
    assert_false(fails(1));
    assert_false(verdict(ISO_REASON_MATCH, 2, 2)); /* it resets the failures */
    assert_false(fails(3));
    assert_false(fails(4));
    expect(ISO_REASON_NONE, 0, 4);
    assert_true(fails(5));
    expect(ISO_REASON_LOCKED_OUT, 10, 5);
    assert_int_equal(iso_lockout_due_ns(&lockout), 15 * S);
    assert_false(iso_lockout_time(&lockout, 15 * S - 1));
    assert_true(iso_lockout_time(&lockout, 15 * S));
    expect(ISO_REASON_NONE, 0, 15);
}

static void locks_after_attacks_although_people_are_admitted(void **state)
{
    (void)state;
    assert_false(verdict(ISO_REASON_ATTACK, 0, 1));
    assert_false(verdict(ISO_REASON_MATCH, 2, 2));
    assert_true(verdict(ISO_REASON_ATTACK, 0, 3));
    expect(ISO_REASON_LOCKED_OUT, 10, 3);
}

static void counts_visits_that_could_have_been_recognised(void **state)
{
    static const struct {
        enum iso_reason reason;
        int frames;
        bool counts;
    } cases[] = {
        {ISO_REASON_UNKNOWN, 6, true},   {ISO_REASON_ATTACK, 0, true},
        {ISO_REASON_LEFT, 2, true},      {ISO_REASON_LEFT, 1, false},
        {ISO_REASON_MATCH, 2, false},    {ISO_REASON_NOT_VALID, 2, false},
        {ISO_REASON_UNLOGGED, 2, false}, {ISO_REASON_LOCKED_OUT, 6, false},
        {ISO_REASON_LOCKDOWN, 6, false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct iso_verdict v = {.reason = cases[i].reason, .frames = cases[i].frames};
        assert_int_equal(iso_lockout_counts(&v, AGREE), cases[i].counts);
    }
}

/* Locks at t_s. Returns for how many seconds. */
static int64_t lock_at(int64_t t_s)
{
    bool locked = false;
    for (int i = 0; i < options.failures; i++) {
        assert_false(locked);
        locked = fails(t_s);
    }
    assert_true(locked);
    return iso_lockout_remaining_ns(&lockout, t_s * S) / S;
}

static void each_lock_is_twice_as_long_up_to_the_longest(void **state)
{
    static const int64_t lengths_s[] = {10, 20, 40, 50, 50};
    int64_t t_s = 0;
    (void)state;
    for (size_t i = 0; i < sizeof lengths_s / sizeof *lengths_s; i++) {
        assert_int_equal(lock_at(t_s), lengths_s[i]);
        t_s += lengths_s[i];
        assert_true(iso_lockout_time(&lockout, t_s * S));
    }
    /* The last lock ends at t_s and is forgotten forget_ns later. */
    assert_int_equal(iso_lockout_due_ns(&lockout), (t_s + 100) * S);
    assert_int_equal(lock_at(t_s + 100), 10);
}

static void nothing_counts_while_it_lasts(void **state)
{
    (void)state;
    (void)lock_at(0);
    for (int i = 0; i < 20; i++) {
        assert_false(fails(i / 4));
    }
    expect(ISO_REASON_LOCKED_OUT, 5, 5);
    assert_true(iso_lockout_time(&lockout, 10 * S));
    assert_false(fails(11));
    assert_false(fails(11));
}

static void forgets_failures_in_time(void **state)
{
    (void)state;
    assert_false(fails(0));
    assert_false(fails(99));
    assert_int_equal(iso_lockout_due_ns(&lockout), 199 * S);
    assert_true(iso_lockout_time(&lockout, 199 * S));
    assert_int_equal(iso_lockout_due_ns(&lockout), ISO_NEVER_NS);
    assert_false(fails(200));
    assert_false(fails(201));
}

static void is_cleared(void **state)
{
    (void)state;
    (void)lock_at(0);
    iso_lockout_clear(&lockout);
    expect(ISO_REASON_NONE, 0, 0);
    assert_int_equal(lock_at(1), 10);
}

static void zero_never_locks(void **state)
{
    const struct iso_lockout_options never = {.first_ns = S, .longest_ns = S, .forget_ns = S};
    (void)state;
    iso_lockout_init(&lockout, &never);
    for (int i = 0; i < 100; i++) {
        assert_false(fails(0));
        assert_false(verdict(ISO_REASON_ATTACK, 0, 0));
    }
}

static void lockdown_goes_before_all_and_outlasts_a_clear(void **state)
{
    (void)state;
    (void)lock_at(0);
    lockout.lockdown = true;
    assert_int_equal(iso_lockout_refusal(&lockout), ISO_REASON_LOCKDOWN);
    iso_lockout_clear(&lockout);
    assert_int_equal(iso_lockout_refusal(&lockout), ISO_REASON_LOCKDOWN);
}

/* ---- over a restart ---- */

static void outlasts_a_restart_with_a_clock_of_its_own(void **state)
{
    const char *path = scratch_path(*state, "lockout");
    struct iso_lockout_record record;
    struct iso_lockout_file file = {.number = 0};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_lockout_load(path, stores_ring(*state), &file, &fault), -ENOENT);
    (void)lock_at(1000);
    (void)verdict(ISO_REASON_UNKNOWN, 6, 1004);
    record = iso_lockout_record_of(&lockout, 1004 * S);
    assert_int_equal(iso_lockout_save(path, stores_ring(*state), &record, &fault), 0);
    stores_forget();
    assert_int_equal(iso_lockout_load(path, stores_ring(*state), &file, &fault), 0);
    assert_int_equal(file.number, 1);
    iso_lockout_init(&lockout, &options);
    iso_lockout_restore(&lockout, &file.record, 3 * S);
    expect(ISO_REASON_LOCKED_OUT, 6, 3);
    assert_true(iso_lockout_time(&lockout, 9 * S));
    assert_int_equal(lock_at(9), 20); /* the second lock */
    assert_int_equal(access(scratch_path(*state, "lockout.new"), F_OK), -1);
}

static void impossible_numbers_count_as_the_worst(void **state)
{
    const struct iso_lockout_record record = {
        .failures = -4, .attacks = 0, .locks = 1 << 30, .remaining_ns = INT64_MAX};
    (void)state;
    iso_lockout_restore(&lockout, &record, 7 * S);
    expect(ISO_REASON_LOCKED_OUT, 50, 7);
    assert_true(iso_lockout_time(&lockout, 57 * S));
    assert_int_equal(lock_at(57), 50);
}

static void expect_refused(void *directory, int error, const char *words)
{
    struct iso_lockout_file file = {.number = 77};
    struct iso_fault fault = {.text = ""};
    const char *path = scratch_path(directory, "lockout");
    assert_int_equal(iso_lockout_load(path, stores_ring(directory), &file, &fault), error);
    assert_int_equal(file.number, 77);
    assert_non_null(strstr(fault.text, path));
    assert_non_null(strstr(fault.text, words));
}

static void every_damage_of_the_file_is_found(void **state)
{
    const char *path = scratch_path(*state, "lockout");
    const struct iso_lockout_record record = {3, 1, 2, 1500 * ISO_NS_PER_MS, true};
    struct iso_fault fault;
    size_t size;
    assert_int_equal(iso_lockout_save(path, stores_ring(*state), &record, &fault), 0);
    char *good = scratch_read(path, &size);
    char *bad = malloc(size + 1);
    assert_non_null(bad);
    for (size_t bit = 0; bit < 8 * size; bit++) {
        memcpy(bad, good, size);
        bad[bit / 8] = (char)(bad[bit / 8] ^ 1 << bit % 8);
        scratch_write(path, bad, size);
        expect_refused(*state, -EBADMSG, "damaged");
    }
    for (size_t length = 0; length <= size + 1; length++) {
        memcpy(bad, good, size);
        bad[size] = 'x';
        scratch_write(path, bad, length);
        if (length != size) {
            expect_refused(*state, -EBADMSG, "damaged");
        }
    }
    free(good);
    free(bad);
}

static void a_file_written_with_another_key_is_refused(void **state)
{
    const struct iso_lockout_record record = {.failures = 4, .locks = 2};
    const char *path = scratch_path(*state, "lockout");
    struct iso_fault fault;
    void *other = NULL;
    stores_forget();
    assert_int_equal(scratch_setup(&other), 0);
    assert_int_equal(iso_lockout_save(path, stores_ring(other), &record, &fault), 0);
    stores_forget();
    expect_refused(*state, -EBADMSG, "damaged");
    assert_int_equal(scratch_teardown(&other), 0);
}

static const char text_1[] = "isotherm-lockout 1 5 2 3 119500 open 9286bdc4\n";

static void the_file_of_the_previous_version_is_read_until_there_is_a_sealed_one(void **state)
{
    const char *path = scratch_path(*state, "lockout");
    struct iso_lockout_file file;
    struct iso_fault fault;
    scratch_write_text(path, text_1);
    assert_int_equal(iso_lockout_load(path, stores_ring(*state), &file, &fault), 0);
    assert_int_equal(file.number, 0);
    assert_int_equal(file.record.failures, 5);
    assert_int_equal(file.record.attacks, 2);
    assert_int_equal(file.record.locks, 3);
    assert_int_equal(file.record.remaining_ns, 119500 * ISO_NS_PER_MS);
    assert_int_equal(iso_lockout_save(path, stores_ring(*state), &file.record, &fault), 0);
    struct iso_lockout_file sealed;
    assert_int_equal(iso_lockout_load(path, stores_ring(*state), &sealed, &fault), 0);
    assert_int_equal(sealed.number, 1);
    assert_int_equal(sealed.record.failures, 5);
    assert_int_equal(sealed.record.attacks, 2);
    assert_int_equal(sealed.record.locks, 3);
    assert_int_equal(sealed.record.remaining_ns, file.record.remaining_ns);
    assert_false(sealed.record.lockdown);
    /* Once a store knows the sealed file, a file that anyone can write is refused. */
    assert_int_equal(iso_key_ring_renew(stores_ring(*state), &fault), 0);
    stores_forget();
    scratch_write_text(path, text_1);
    expect_refused(*state, -ESTALE, "earlier time");
}

static void damage_of_the_previous_version_is_found(void **state)
{
    char bad[sizeof text_1];
    struct iso_lockout_record read = {.failures = 77};
    const size_t size = strlen(text_1);
    for (size_t bit = 0; bit < 8 * size; bit++) {
        memcpy(bad, text_1, sizeof bad);
        bad[bit / 8] = (char)(bad[bit / 8] ^ 1 << bit % 8);
        assert_int_equal(iso_lockout_parse(bad, size, &read), -EBADMSG);
    }
    for (size_t length = 0; length < size; length++) {
        memcpy(bad, text_1, sizeof bad);
        bad[length] = '\0';
        assert_int_equal(iso_lockout_parse(bad, length, &read), -EBADMSG);
    }
    assert_int_equal(read.failures, 77);
    scratch_write_text(scratch_path(*state, "lockout"),
                       "isotherm-lockout 1 0 0 0 0 open 00000000\n");
    expect_refused(*state, -EBADMSG, "damaged");
}

static void a_missing_or_old_file_is_noticed(void **state)
{
    struct iso_lockout_record record = {.failures = 1};
    const char *path = scratch_path(*state, "lockout");
    struct iso_fault fault;
    size_t size;
    assert_int_equal(iso_lockout_save(path, stores_ring(*state), &record, &fault), 0);
    char *old = scratch_read(path, &size);
    record.failures = 2;
    assert_int_equal(iso_lockout_save(path, stores_ring(*state), &record, &fault), 0);
    /* The ring on the disk now has the number of the second file. */
    assert_int_equal(iso_key_ring_renew(stores_ring(*state), &fault), 0);
    stores_forget();
    scratch_write(path, old, size);
    expect_refused(*state, -ESTALE, "earlier time");
    assert_int_equal(unlink(path), 0);
    stores_forget();
    expect_refused(*state, -ESTALE, "is gone");
    /* The next file is newer than all known ones. */
    assert_int_equal(iso_lockout_save(path, stores_ring(*state), &record, &fault), 0);
    struct iso_lockout_file file;
    assert_int_equal(iso_lockout_load(path, stores_ring(*state), &file, &fault), 0);
    assert_int_equal(file.number, 3);
    free(old);
}

static void a_file_that_cannot_be_written_stays_as_it_was(void **state)
{
    const struct iso_lockout_record record = {.failures = 1};
    struct iso_fault fault = {.text = ""};
    const char *path = scratch_path(*state, "none/lockout");
    assert_int_equal(iso_lockout_save(path, stores_ring(*state), &record, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "cannot be written"));
    assert_int_equal(mkdir(scratch_path(*state, "lockout.new"), 0700), 0);
    path = scratch_path(*state, "lockout");
    scratch_write_text(path, "as it was");
    assert_int_equal(iso_lockout_save(path, stores_ring(*state), &record, &fault), -EISDIR);
    size_t size;
    char *text = scratch_read(path, &size);
    assert_memory_equal(text, "as it was", size);
    free(text);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(locks_after_failures_in_a_row),
        TEST(locks_after_attacks_although_people_are_admitted),
        TEST(counts_visits_that_could_have_been_recognised),
        TEST(each_lock_is_twice_as_long_up_to_the_longest),
        TEST(nothing_counts_while_it_lasts),
        TEST(forgets_failures_in_time),
        TEST(is_cleared),
        TEST(zero_never_locks),
        TEST(lockdown_goes_before_all_and_outlasts_a_clear),
        TEST(outlasts_a_restart_with_a_clock_of_its_own),
        TEST(impossible_numbers_count_as_the_worst),
        TEST(every_damage_of_the_file_is_found),
        TEST(a_file_written_with_another_key_is_refused),
        TEST(the_file_of_the_previous_version_is_read_until_there_is_a_sealed_one),
        TEST(damage_of_the_previous_version_is_found),
        TEST(a_missing_or_old_file_is_noticed),
        TEST(a_file_that_cannot_be_written_stays_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

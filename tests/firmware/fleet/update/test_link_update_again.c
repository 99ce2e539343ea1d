/* Each reason for which an update is refused: how often it is tried, when it is tried again, and
 * that the manual says the same. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/file/disk_room.h"
#include "firmware/fleet/update/update_inner.h"
#include "tests/firmware/fleet/update/update_rig.h"
#include "tests/support/scratch.h"

static const char part[] = "var/lib/isotherm-update/hub/bundle.part";

static const char *fault_of(const struct update_rig *rig)
{
    return link_update_report(rig->update)->fault;
}

/* Runs the loop until the door says why it is not further. */
static void wait_for_refusal(struct update_rig *rig, const char *why)
{
    for (int i = 0; i < 1200 && !strstr(fault_of(rig), why); i++) {
        update_rig_turn(rig);
    }
    assert_non_null(strstr(fault_of(rig), why));
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
}

static unsigned tries(const struct update_rig *rig, const char *code)
{
    return rig->update->record.tries[link_update_reason(code)];
}

/* Nothing is in the way any more. */
static void expect_success(struct update_rig *rig)
{
    update_rig_slots(rig, "1.1", true, true);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_expect_installed(rig);
    assert_string_equal(fault_of(rig), "");
}

/* ---- how often ---- */

/* RAUC was busy four times, which says nothing of the next refusal. */
static void reasons_are_counted_apart(void **state)
{
    struct update_rig *rig = *state;
    update_rig_begin(rig, "busy\nbusy\nbusy\nbusy\nnot-installed\n\n");
    wait_for_refusal(rig, "refused: not-installed");
    assert_int_equal(tries(rig, "busy"), 4);
    assert_int_equal(tries(rig, "not-installed"), 1);
    expect_success(rig);
}

static void counts_are_stored_for_each_reason(void **state)
{
    struct update_rig *rig = *state;
    struct link_update_record record = {
        .rollout = rig->order.rollout, .version = "1.2", .state = ISO_FLEET_UPDATE_FETCHING};
    struct link_update_record read = record;
    char path[320];
    (void)snprintf(path, sizeof path, "%s/update.record", rig->folder);
    record.tries[link_update_reason("busy")] = 7;
    record.tries[link_update_reason("disk")] = 2;
    assert_int_equal(link_update_record_write(path, &record, NULL), 0);
    link_update_record_read(path, &read);
    assert_memory_equal(read.tries, record.tries, sizeof read.tries);
    /* An earlier version has counted all of them in one. */
    size_t size = 0;
    char *text = (char *)scratch_read(path, &size);
    char *begin = memmem(text, size, "{\n    \"", 7);
    assert_non_null(begin);
    char *end = memchr(begin, '}', size - (size_t)(begin - text));
    assert_non_null(end);
    memset(begin, ' ', (size_t)(end - begin) + 1);
    *begin = '5';
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    free(text);
    link_update_record_read(path, &read);
    assert_int_equal(read.state, ISO_FLEET_UPDATE_FETCHING);
    for (size_t i = 0; i < LINK_UPDATE_REASONS; i++) {
        assert_int_equal(read.tries[i], 0);
    }
}

/* A row of the table: ".It CODE, CODE Ta TRIES Ta REASON". */
static size_t check_row(char *row)
{
    size_t n = 0;
    char *number = strstr(row, " Ta ");
    assert_non_null(number);
    *number = '\0';
    const unsigned long expected = strtoul(number + 4, NULL, 10);
    for (char *code = strtok(row, ", "); code; code = strtok(NULL, ", ")) {
        const size_t reason = link_update_reason(code);
        assert_string_equal(link_update_reason_code(reason), code);
        assert_int_equal(link_update_tries(code), expected);
        n++;
    }
    return n;
}

static void the_manual_has_each_reason(void **state)
{
    size_t size = 0, n = 0;
    (void)state;
    uint8_t *bytes = scratch_read(ISOTHERM_SOURCE_DIR "/enroll/man/isotherm-link.8", &size);
    char *text = strndup((const char *)bytes, size), *table = strstr(text, ".Bl -column");
    assert_non_null(table);
    *strstr(table, ".El") = '\0';
    char *next = strstr(table, "\n.It ") + 5; /* the heads */
    while ((next = strstr(next, "\n.It ")) != NULL) {
        char row[200];
        next += 5;
        (void)snprintf(row, sizeof row, "%.*s", (int)strcspn(next, "\n"), next);
        n += check_row(row);
    }
    assert_int_equal(n, LINK_UPDATE_REASONS);
    assert_null(link_update_reason_code(LINK_UPDATE_REASONS));
    assert_string_equal(link_update_reason_code(link_update_reason("unheard-of")), "not-installed");
    free(text);
    free(bytes);
}

/* ---- when ---- */

static uint64_t time_to_wait_us(const struct update_rig *rig)
{
    uint64_t at = 0;
    assert_int_equal(sd_event_source_get_time(rig->update->timer, &at), 0);
    const uint64_t now = link_update_now_us(rig->update);
    return at > now ? at - now : 0;
}

/* The file is damaged at the hub, so all doors of a stage fetch it again. Two of two random parts
 * of four hours are less than a second once in 200 million times. */
static void a_file_that_is_fetched_again_waits_for_its_turn(void **state)
{
    struct update_rig *rig = *state;
    uint64_t longest = 0;
    rig->is_damaged = true;
    update_rig_begin(rig, "\n");
    for (unsigned i = 1; i <= 2; i++) {
        rig->update->order.spread_s = 4 * 3600;
        while (tries(rig, "damaged") < i) {
            update_rig_turn(rig);
        }
        assert_false(update_rig_has(rig, part));
        longest = time_to_wait_us(rig) > longest ? time_to_wait_us(rig) : longest;
        link_update_in(rig->update, 0);
    }
    assert_true(longest > LINK_UPDATE_S_US);
}

static void a_file_that_is_complete_does_not(void **state)
{
    struct update_rig *rig = *state;
    update_rig_begin(rig, "busy\n\n");
    rig->update->order.spread_s = 4 * 3600;
    wait_for_refusal(rig, "refused: busy");
    assert_true(time_to_wait_us(rig) <= LINK_UPDATE_S_US);
    expect_success(rig);
    assert_int_equal(rig->begins, 1);
}

/* ---- each reason ---- */

static void a_disk_that_is_too_small_is_told_at_once(void **state)
{
    struct update_rig *rig = *state;
    rig->order.size = UINT64_MAX / 2;
    update_rig_begin(rig, "\n");
    update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
    assert_string_equal(fault_of(rig), "the disk is too small for the update");
    assert_int_equal(rig->server.requests, 0);
}

/* Others use the room for a time: more than is free, and less than the disk has. */
static void a_full_disk_is_waited_for(void **state)
{
    struct update_rig *rig = *state;
    const uint64_t room = iso_disk_room(rig->folder), size = iso_disk_size(rig->folder);
    assert_true(room < size);
    rig->order.size = room + (size - room) / 2;
    update_rig_begin(rig, "\n");
    wait_for_refusal(rig, "the disk has no room for the update");
    assert_int_equal(tries(rig, "no-room"), 1);
    assert_int_equal(rig->server.requests, 0);
    rig->update->order.size = UPDATE_FILE_BYTES;
    expect_success(rig);
}

/* The hub answers questions, and 20 requests in a row have brought no part. */
static void a_hub_that_gives_no_part_refuses(void **state)
{
    struct update_rig *rig = *state;
    rig->status = 503;
    update_rig_begin(rig, "\n");
    update_rig_run(rig, 1);
    rig->update->backoff.failures = 19;
    wait_for_refusal(rig, "it could not be fetched: the hub refuses a part of the update");
    assert_int_equal(tries(rig, "not-fetched"), 1);
    rig->status = 200;
    expect_success(rig);
}

static void a_part_of_another_file_is_not_stored(void **state)
{
    struct update_rig *rig = *state;
    rig->order.size = 100;
    update_rig_begin(rig, "\n");
    update_rig_run(rig, 1);
    while (rig->update->backoff.failures == 0) {
        update_rig_turn(rig);
    }
    assert_int_equal(rig->update->have, 0);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
}

/* Something cuts it off between the fetch and the check. */
static void a_file_that_is_cut_off_is_fetched_again(void **state)
{
    struct update_rig *rig = *state;
    char path[400];
    update_rig_begin(rig, "\n");
    while (rig->update->step != LINK_UPDATE_CHECK) {
        update_rig_turn(rig);
    }
    (void)snprintf(path, sizeof path, "%s/%s", rig->folder, part);
    assert_int_equal(truncate(path, 100), 0);
    wait_for_refusal(rig, "the file cannot be read again");
    assert_int_equal(tries(rig, "damaged"), 1);
    expect_success(rig);
    assert_int_equal(rig->begins, 2);
}

/* No unit looks at the folder for two hours. */
static void an_image_that_does_not_take_the_file_refuses(void **state)
{
    struct update_rig *rig = *state;
    rig->has_no_units = true;
    update_rig_begin(rig, "\n");
    while (!update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.raucb")) {
        update_rig_turn(rig);
    }
    rig->update->handed_us = link_update_now_us(rig->update) - 7201 * LINK_UPDATE_S_US;
    wait_for_refusal(rig, "the image does not take the update");
    assert_int_equal(tries(rig, "not-taken"), 1);
    assert_false(update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.raucb"));
    rig->has_no_units = false;
    expect_success(rig);
    assert_int_equal(rig->begins, 1);
}

/* Something else has the name under which the image takes it. */
static void a_file_that_cannot_be_given_is_given_later(void **state)
{
    struct update_rig *rig = *state;
    char path[400];
    (void)snprintf(path, sizeof path, "%s/hub/bundle.raucb", rig->state);
    assert_int_equal(mkdir(path, 0700), 0);
    rig->has_no_units = true;
    update_rig_begin(rig, "\n");
    wait_for_refusal(rig, "cannot be given to the image");
    assert_int_equal(tries(rig, "disk"), 1);
    assert_int_equal(rmdir(path), 0);
    rig->has_no_units = false;
    expect_success(rig);
}

/* The link was started again, and learns that RAUC was busy; the order has to come first. */
static void a_refusal_during_a_restart_keeps_the_file(void **state)
{
    struct update_rig *rig = *state;
    char path[400];
    rig->has_no_units = true;
    update_rig_begin(rig, "\n");
    while (!update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.raucb")) {
        update_rig_turn(rig);
    }
    update_rig_stop(rig);
    (void)snprintf(path, sizeof path, "%s/hub/bundle.raucb", rig->state);
    assert_int_equal(unlink(path), 0);
    (void)snprintf(path, sizeof path, "%s/result-hub.json", rig->state);
    scratch_write_text(path, "{\"from\":\"hub\",\"result\":{\"error\":{\"code\":\"busy\","
                             "\"message\":\"busy\"}}}\n");
    rig->tells = 0;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    assert_true(update_rig_has(rig, part));
    assert_int_equal(tries(rig, "busy"), 1);
    rig->has_no_units = false;
    update_rig_order(rig);
    assert_int_equal(tries(rig, "busy"), 1);
    expect_success(rig);
    assert_int_equal(rig->begins, 1);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, update_rig_setup, update_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(reasons_are_counted_apart),
        TEST(counts_are_stored_for_each_reason),
        cmocka_unit_test(the_manual_has_each_reason),
        TEST(a_file_that_is_fetched_again_waits_for_its_turn),
        TEST(a_file_that_is_complete_does_not),
        TEST(a_disk_that_is_too_small_is_told_at_once),
        TEST(a_full_disk_is_waited_for),
        TEST(a_hub_that_gives_no_part_refuses),
        TEST(a_part_of_another_file_is_not_stored),
        TEST(a_file_that_is_cut_off_is_fetched_again),
        TEST(an_image_that_does_not_take_the_file_refuses),
        TEST(a_file_that_cannot_be_given_is_given_later),
        TEST(a_refusal_during_a_restart_keeps_the_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

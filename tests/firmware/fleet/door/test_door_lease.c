/* The lease of a door: by the clock of the boot, over a restart, a reboot and a jump of the date;
 * answers that are old, repeated or of another door; joining and leaving. */
#include <errno.h>
#include <string.h>

#include "drivers/base/times.h"
#include "tests/firmware/fleet/door/door_rig.h"
#include "tests/firmware/rigs/gallery_rig.h"

/* ---- the term alone ---- */

static const struct iso_fleet_clocks begin = {
    .boot_ns = 50 * ISO_NS_PER_S, .boot_id = {1}, .date_s = 1800000000, .date_known = true};

static void a_term_ends_by_the_clock_of_the_boot(void **state)
{
    const struct iso_fleet_term term = {.begin = begin, .length_s = 100};
    struct iso_fleet_clocks now = begin;
    (void)state;
    assert_int_equal(iso_fleet_term_left_ns(&(struct iso_fleet_term){.length_s = 0}, &now), 0);
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 100 * ISO_NS_PER_S);
    now.date_s += 1000000; /* whatever the date */
    now.date_known = false;
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 100 * ISO_NS_PER_S);
    now.boot_ns += 100 * ISO_NS_PER_S - 1;
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 1);
    now.boot_ns++;
    now.date_s = begin.date_s;
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 0);
    now.boot_ns = begin.boot_ns - 1; /* that clock never runs backwards */
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 0);
}

static void after_a_reboot_a_known_date_counts(void **state)
{
    struct iso_fleet_term term = {.begin = begin, .length_s = 100};
    struct iso_fleet_clocks now = begin;
    (void)state;
    now.boot_id[15] = 9;
    now.boot_ns = 1;
    now.date_s += 99;
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), ISO_NS_PER_S);
    now.date_s++;
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 0);
    now.date_s = begin.date_s - 1; /* set back */
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 0);
    now.date_s = begin.date_s + 1;
    now.date_known = false;
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 0);
    now.date_known = true;
    term.begin.date_known = false;
    assert_int_equal(iso_fleet_term_left_ns(&term, &now), 0);
}

/* ---- the door ---- */

static void begin_with_ada(struct door_rig *rig)
{
    door_rig_begin(rig, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 2, 2, "ben", 40, true)),
                     ISO_FLEET_APPLIED);
}

static void a_lease_that_is_over_keeps_people_out(void **state)
{
    struct door_rig *rig = *state;
    char why[ISO_FLEET_WHY_SIZE];
    int64_t due_ns;
    begin_with_ada(rig);
    (void)iso_fleet_time(rig->fleet, &due_ns);
    assert_true(door_rig_noted(rig, "lease-held"));
    assert_string_equal(iso_fleet_why(rig->fleet, why), "");
    rig->now.boot_ns += 3600 * ISO_NS_PER_S - 1;
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_MAY_ENTER);
    rig->now.boot_ns++;
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_NO_LEASE);
    assert_int_equal(door_rig_admission(rig, "ben"), ISO_FLEET_MAY_ENTER);
    (void)iso_fleet_time(rig->fleet, &due_ns);
    assert_true(door_rig_noted(rig, "lease-over"));
    assert_string_equal(iso_fleet_why(rig->fleet, why),
                        "no lease: the hub has not answered since 2027-01-15T08:00:00Z");
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_MAY_ENTER);
}

/* Somebody who holds a revocation back, and lets answers pass, does not keep the door at work: the
 * earlier lease ends, and the new one counts only with the revocation. */
static void an_answer_does_not_count_without_the_changes(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    struct iso_fleet_bytes held_back = door_rig_remove(rig, 0, 1, 3);
    for (int i = 0; i < 4; i++) {
        rig->now.boot_ns += 1000 * ISO_NS_PER_S;
        assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    }
    assert_int_equal(door_rig_status(rig).lease_left_ns, 0);
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_NO_LEASE);
    assert_int_equal(door_rig_give(rig, held_back), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 3600 * ISO_NS_PER_S);
}

/* A shorter lease is no extension, and counts at once. */
static void a_shorter_lease_counts_at_once(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    struct iso_fleet_bytes held_back = door_rig_remove(rig, 0, 1, 3);
    rig->lease_s = 60;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 60 * ISO_NS_PER_S);
    iso_fleet_bytes_free(&held_back);
}

/* The lease runs from the question, not from the answer. */
static void a_slow_answer_gives_less(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    struct iso_fleet_bytes lease = door_rig_lease(rig, 1);
    rig->now.boot_ns += 3000 * ISO_NS_PER_S;
    assert_int_equal(door_rig_give(rig, lease), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 600 * ISO_NS_PER_S);
}

static void a_lease_goes_on_over_a_restart(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    door_rig_restart(rig);
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_MAY_ENTER);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 3600 * ISO_NS_PER_S);
    rig->now.boot_id[0] = 2; /* a reboot, with a date */
    rig->now.boot_ns = 1;
    rig->now.date_s += 3599;
    door_rig_restart(rig);
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_MAY_ENTER);
    rig->now.date_known = false; /* and without one */
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_NO_LEASE);
}

/* Not every answer goes to the disk, but a shorter lease does. */
static void what_is_stored_never_holds_longer(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    const uint64_t changes = iso_gallery_version(rig->gallery).changes;
    rig->now.boot_ns += 60 * ISO_NS_PER_S;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_int_equal(iso_gallery_version(rig->gallery).changes, changes);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 3600 * ISO_NS_PER_S);
    door_rig_restart(rig);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 3540 * ISO_NS_PER_S);
    rig->now.boot_ns += 600 * ISO_NS_PER_S;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    door_rig_restart(rig);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 3600 * ISO_NS_PER_S);
    rig->lease_s = 0; /* never without the hub */
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).lease_left_ns, ISO_FLEET_LEASE_ONLINE_S * ISO_NS_PER_S);
    assert_int_equal(door_rig_status(rig).lease_s, 0);
    door_rig_restart(rig);
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_NO_LEASE);
}

static struct iso_fleet_bytes copy_of(const struct iso_fleet_bytes *bytes)
{
    struct iso_fleet_bytes copy = {.bytes = NULL};
    iso_fleet_put(&copy, bytes->bytes, bytes->size);
    assert_int_equal(copy.error, 0);
    return copy;
}

/* A hub with many doors answers late, when the door has asked again. */
static void each_answer_counts_once_and_from_its_question(void **state)
{
    struct door_rig *rig = *state;
    struct iso_fleet_bytes answers[5], again[5];
    begin_with_ada(rig);
    for (int i = 0; i < 5; i++) {
        rig->now.boot_ns += 10 * ISO_NS_PER_S;
        answers[i] = door_rig_lease(rig, 1);
        again[i] = copy_of(&answers[i]);
    }
    rig->now.boot_ns += 3500 * ISO_NS_PER_S;
    assert_int_equal(door_rig_give(rig, answers[0]), ISO_FLEET_REFUSED); /* the fifth but last */
    assert_int_equal(door_rig_give(rig, answers[2]), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 80 * ISO_NS_PER_S);
    assert_int_equal(door_rig_give(rig, again[2]), ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_give(rig, answers[1]), ISO_FLEET_REFUSED); /* older than the last */
    assert_int_equal(door_rig_give(rig, answers[4]), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).lease_left_ns, 100 * ISO_NS_PER_S);
    assert_int_equal(door_rig_give(rig, answers[3]), ISO_FLEET_REFUSED);
    for (int i = 0; i < 5; i++) {
        if (i != 2) {
            assert_int_equal(door_rig_give(rig, again[i]), ISO_FLEET_REFUSED);
        }
    }
    assert_int_equal(door_rig_status(rig).lease_left_ns, 100 * ISO_NS_PER_S);
    struct iso_fleet_bytes late = door_rig_lease(rig, 1);
    door_rig_restart(rig); /* the question is forgotten with the daemon */
    assert_int_equal(door_rig_give(rig, late), ISO_FLEET_REFUSED);
}

static void every_changed_byte_of_a_lease_is_noticed(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    struct iso_fleet_bytes lease = door_rig_lease(rig, 1);
    for (size_t at = 0; at < lease.size; at++) {
        struct iso_fleet_bytes copy = {.bytes = NULL};
        iso_fleet_put(&copy, lease.bytes, lease.size);
        copy.bytes[at] ^= 4;
        assert_int_equal(door_rig_give(rig, copy), ISO_FLEET_REFUSED);
    }
    assert_int_equal(door_rig_give(rig, lease), ISO_FLEET_APPLIED);
}

static void a_list_with_a_zone_twice_is_refused(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    rig->zone[1].place.zone = rig->zone[0].place.zone;
    assert_int_equal(door_rig_answer(rig, 2), ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_status(rig).n, 1);
}

/* ---- joining and leaving ---- */

static void a_door_belongs_to_one_fleet(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    const struct iso_fleet_signer hub = rig->hub;
    (void)crypto_sign_keypair(rig->hub.public, rig->hub.secret);
    struct iso_fleet_bytes other = door_rig_membership(rig);
    rig->hub = hub;
    assert_int_equal(iso_fleet_join(rig->fleet, other.bytes, other.size, "me", NULL), -EEXIST);
    assert_int_equal(iso_fleet_leave(rig->fleet, "me", NULL), 0);
    assert_true(door_rig_noted(rig, "left - HQ -> - (me)"));
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    assert_int_equal(door_rig_person(rig, "ben"), 0);
    assert_int_equal(iso_fleet_leave(rig->fleet, "me", NULL), -ENOENT);
    door_rig_restart(rig);
    assert_false(iso_fleet_is_member(rig->fleet));
    assert_int_equal(iso_fleet_join(rig->fleet, other.bytes, other.size - 1, "me", NULL),
                     -EKEYREJECTED);
    const struct iso_fleet_signer own = rig->door_signs;
    (void)crypto_sign_keypair(rig->door_signs.public, rig->door_signs.secret);
    assert_int_equal(iso_fleet_join(rig->fleet, other.bytes, other.size, "me", NULL),
                     -EKEYREJECTED); /* for another door */
    rig->door_signs = own;
    assert_int_equal(iso_fleet_join(rig->fleet, other.bytes, other.size, "me", NULL), 0);
    assert_string_equal(iso_fleet_hub_name(rig->fleet), "HQ");
    iso_fleet_bytes_free(&other);
}

static void a_door_that_has_left_lets_its_own_people_in(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    assert_int_equal(gallery_rig_add(rig->gallery, "visitor", 60, NULL), 0);
    assert_int_equal(door_rig_admission(rig, "visitor"), ISO_FLEET_NOT_APPROVED);
    assert_int_equal(iso_fleet_leave(rig->fleet, "me", NULL), 0);
    assert_int_equal(door_rig_admission(rig, "visitor"), ISO_FLEET_MAY_ENTER);
    struct iso_credential_record stray = iso_credential_record_new();
    stray.fleet.revision = 1; /* left over from a fleet, however */
    stray.fleet.offline_ok = true;
    assert_int_equal(iso_fleet_admission(rig->fleet, &stray), ISO_FLEET_NO_LEASE);
}

/* A program that does not understand the record must not let people in by it. */
static void a_record_of_a_newer_version_keeps_people_out(void **state)
{
    struct door_rig *rig = *state;
    uint8_t bytes[64] = {99};
    begin_with_ada(rig);
    assert_int_equal(gallery_rig_add(rig->gallery, "visitor", 60, NULL), 0);
    assert_int_equal(
        iso_gallery_set_access(rig->gallery, ISO_GALLERY_FLEET, bytes, sizeof bytes, NULL), 0);
    door_rig_restart(rig);
    struct iso_fleet_status now;
    assert_int_equal(iso_fleet_get_status(rig->fleet, &now, NULL), -EPROTONOSUPPORT);
    assert_true(iso_fleet_is_member(rig->fleet));
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_NO_LEASE);
    assert_int_equal(door_rig_admission(rig, "ben"), ISO_FLEET_NO_LEASE);
    assert_int_equal(door_rig_admission(rig, "visitor"), ISO_FLEET_NOT_APPROVED);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, door_rig_setup, door_rig_teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_term_ends_by_the_clock_of_the_boot),
        cmocka_unit_test(after_a_reboot_a_known_date_counts),
        TEST(a_lease_that_is_over_keeps_people_out),
        TEST(an_answer_does_not_count_without_the_changes),
        TEST(a_shorter_lease_counts_at_once),
        TEST(a_slow_answer_gives_less),
        TEST(a_lease_goes_on_over_a_restart),
        TEST(what_is_stored_never_holds_longer),
        TEST(each_answer_counts_once_and_from_its_question),
        TEST(every_changed_byte_of_a_lease_is_noticed),
        TEST(a_list_with_a_zone_twice_is_refused),
        TEST(a_door_belongs_to_one_fleet),
        TEST(a_door_that_has_left_lets_its_own_people_in),
        TEST(a_record_of_a_newer_version_keeps_people_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

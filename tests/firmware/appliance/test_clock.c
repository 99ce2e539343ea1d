/* The clock is set back behind the newest record of the log. People with time limits are refused,
 * others are admitted, the fault is reported and recorded, and a restart keeps it. */
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/puppets.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/firmware/rigs/stores.h"

enum { ANNA = 50, BOB = 80 }; /* anna is valid until an hour after the start, bob has no limits */

static const int64_t hour_ns = 3600 * ISO_NS_PER_S;

static int setup(void **state)
{
    if (rig_setup(state)) {
        return -1;
    }
    struct rig *rig = *state;
    const struct iso_person anna = {.name = "anna",
                                    .valid_until_s = rig->wall_ns / ISO_NS_PER_S + 3600};
    const struct iso_template tmpl = puppet_template(ANNA, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_add(rig->gallery, &anna, &tmpl, NULL), 0);
    rig_enrol(rig, "bob", BOB);
    rig_start(rig);
    return 0;
}

/* Shows a face. Returns the report of the visit. */
static const char *visit(struct rig *rig, int face)
{
    rig_run(rig, 8000); /* the previous person has left, and the door has locked */
    (void)rig_news(rig);
    rig_show(rig, face, 2);
    rig_run(rig, 200);
    return rig_news(rig);
}

static enum iso_fault_code code(const struct rig *rig)
{
    return iso_appliance_status(rig->appliance).clock_fault_code;
}

static const char *fault(const struct rig *rig)
{
    return iso_appliance_status(rig->appliance).clock_fault;
}

/* Simulates a restart of the process: the log is closed and read again. segment_bytes: the size
 * from which the log continues in a new segment. */
static void restart_with(struct rig *rig, uint64_t segment_bytes)
{
    struct iso_audit_options options = stores_audit(rig->directory);
    options.sync = false;
    options.segment_bytes = segment_bytes;
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->audit);
    assert_int_equal(iso_audit_open(&options, &rig->borrowed.times, &rig->audit, NULL), 0);
    rig->borrowed.audit = rig->audit;
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    assert_int_equal(iso_appliance_start(rig->appliance, NULL), 0);
}

static void restart(struct rig *rig)
{
    restart_with(rig, stores_audit(rig->directory).segment_bytes);
}

static void an_expired_person_stays_out_when_the_clock_is_set_back(void **state)
{
    struct rig *rig = *state;
    assert_non_null(strstr(visit(rig, ANNA), "visit allow anna"));
    rig->wall_ns += 2 * hour_ns;
    assert_non_null(strstr(visit(rig, ANNA), "visit deny anna not-valid"));
    assert_string_equal(fault(rig), "");

    rig->wall_ns -= 2 * hour_ns;
    assert_non_null(strstr(visit(rig, ANNA), "visit deny anna not-valid"));
    assert_non_null(strstr(visit(rig, BOB), "visit allow bob"));
    assert_non_null(strstr(fault(rig), "the clock was set back"));
    assert_int_equal(iso_appliance_status(rig->appliance).people_valid, 1);
    assert_non_null(strstr(rig_record(rig, "clock"), "\"reason\":\"behind\""));
    assert_int_equal(code(rig), ISO_FAULT_CLOCK_BEHIND);

    rig->wall_ns += 3 * hour_ns;
    assert_non_null(strstr(visit(rig, BOB), "visit allow bob"));
    assert_int_equal(code(rig), ISO_FAULT_NONE);
    assert_string_equal(fault(rig), "");
    assert_non_null(strstr(rig_record(rig, "clock"), "\"reason\":\"right\""));
    assert_non_null(strstr(visit(rig, ANNA), "visit deny anna not-valid"));
}

/* The restart happens twice, because the clock that is behind wrote the records of the first run.
 */
static void a_restart_keeps_the_fault_of_the_clock(void **state)
{
    struct rig *rig = *state;
    rig->wall_ns += 2 * hour_ns;
    (void)visit(rig, BOB);
    rig->wall_ns -= 2 * hour_ns;
    for (int i = 0; i < 2; i++) {
        restart(rig);
        assert_non_null(strstr(visit(rig, ANNA), "visit deny anna not-valid"));
        assert_non_null(strstr(visit(rig, BOB), "visit allow bob"));
        assert_non_null(strstr(fault(rig), "the clock was set back"));
    }
}

/* Each record begins a segment, so that only the newest record is read. */
static void a_new_segment_of_the_log_keeps_the_fault_of_the_clock(void **state)
{
    struct rig *rig = *state;
    rig->wall_ns += 2 * hour_ns;
    (void)visit(rig, BOB);
    rig->wall_ns -= 2 * hour_ns;
    restart_with(rig, 1);
    for (int i = 0; i < 2; i++) {
        assert_non_null(strstr(visit(rig, BOB), "visit allow bob"));
        restart_with(rig, 1);
        assert_non_null(strstr(visit(rig, ANNA), "visit deny anna not-valid"));
        assert_non_null(strstr(fault(rig), "the clock was set back"));
    }
}

/* A clock that ran ahead for a while has left a date in the log that lies in the future. */
static void an_administrator_accepts_the_clock(void **state)
{
    struct rig *rig = *state;
    struct iso_fault why = {.text = ""};
    rig->wall_ns += 1000 * hour_ns;
    (void)visit(rig, BOB);
    rig->wall_ns -= 1000 * hour_ns;
    assert_non_null(strstr(visit(rig, ANNA), "visit deny anna not-valid"));
    assert_int_equal(iso_appliance_clear_lockout(rig->appliance, &why), 0);
    assert_string_equal(fault(rig), "");
    assert_non_null(strstr(rig_record(rig, "clock"), "\"reason\":\"accepted\""));
    assert_non_null(strstr(visit(rig, ANNA), "visit allow anna"));
    restart(rig);
    assert_non_null(strstr(visit(rig, ANNA), "visit allow anna"));
    assert_string_equal(fault(rig), "");
}

/* A correction of less than a minute, as by the network's time, is no fault. It extends no limit.
 */
static void a_small_correction_is_no_fault(void **state)
{
    struct rig *rig = *state;
    rig->wall_ns += hour_ns + 5 * ISO_NS_PER_S;
    assert_non_null(strstr(visit(rig, ANNA), "visit deny anna not-valid"));
    rig->wall_ns -= 50 * ISO_NS_PER_S;
    assert_non_null(strstr(visit(rig, ANNA), "visit deny anna not-valid"));
    assert_string_equal(fault(rig), "");
    assert_string_equal(rig_record(rig, "clock"), "");
}

/* The clock jumps between the two frames of a visit. The date of the verdict decides. */
static const char *visit_with_jump(struct rig *rig, int face, int64_t jump_ns)
{
    rig_run(rig, 8000);
    (void)rig_news(rig);
    rig_show(rig, face, 1);
    rig_run(rig, 40);
    rig->wall_ns += jump_ns;
    rig_show(rig, face, 1);
    rig_run(rig, 200);
    return rig_news(rig);
}

static void jumps_by_months_during_a_visit_prolong_nobodys_limit(void **state)
{
    struct rig *rig = *state;
    const int64_t months_ns = 90 * 24 * hour_ns;
    assert_non_null(strstr(visit_with_jump(rig, ANNA, 0), "visit allow anna match 2"));
    assert_non_null(strstr(visit_with_jump(rig, ANNA, months_ns), "visit deny anna not-valid 2"));
    assert_non_null(strstr(visit_with_jump(rig, ANNA, -months_ns), "visit deny anna not-valid 2"));
    assert_string_not_equal(fault(rig), "");
    assert_non_null(strstr(visit_with_jump(rig, BOB, months_ns), "visit allow bob match 2"));
    assert_non_null(strstr(visit_with_jump(rig, BOB, -3 * months_ns), "visit allow bob match 2"));
    assert_non_null(strstr(visit_with_jump(rig, ANNA, 0), "visit deny anna not-valid 2"));
}

/* An administrator has confirmed the date on a board without a battery. */
static void a_clock_that_is_not_set_is_a_fault_of_its_own(void **state)
{
    struct rig *rig = *state;
    rig->wall_ns = 1000 * ISO_NS_PER_S;
    assert_int_equal(iso_appliance_clear_lockout(rig->appliance, NULL), 0);
    assert_string_equal(fault(rig), "");
    assert_int_equal(code(rig), ISO_FAULT_CLOCK_UNSET);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(an_expired_person_stays_out_when_the_clock_is_set_back,
                                        setup, rig_teardown),
        cmocka_unit_test_setup_teardown(a_clock_that_is_not_set_is_a_fault_of_its_own, setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(a_restart_keeps_the_fault_of_the_clock, setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(a_new_segment_of_the_log_keeps_the_fault_of_the_clock,
                                        setup, rig_teardown),
        cmocka_unit_test_setup_teardown(an_administrator_accepts_the_clock, setup, rig_teardown),
        cmocka_unit_test_setup_teardown(a_small_correction_is_no_fault, setup, rig_teardown),
        cmocka_unit_test_setup_teardown(jumps_by_months_during_a_visit_prolong_nobodys_limit, setup,
                                        rig_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

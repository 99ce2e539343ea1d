/* The appliance and the counter of its state. The counter counts every change of an administrator,
 * also a change without a record after it. Faults of the counter are reported. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/keys/state_counter.h"
#include "tests/firmware/rigs/puppet_counter.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/firmware/rigs/stores.h"

static struct puppet_counter puppet;

static int setup(void **state)
{
    if (rig_setup(state)) {
        return -1;
    }
    struct rig *rig = *state;
    struct iso_audit_options audit = stores_audit(rig->directory);
    puppet = (struct puppet_counter){0};
    const struct iso_counter device = puppet_counter(&puppet);
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->audit);
    assert_int_equal(iso_state_counter_new(&device, &rig->borrowed.times, &rig->borrowed.counter),
                     0);
    audit.counter = rig->borrowed.counter;
    assert_int_equal(iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, NULL), 0);
    assert_int_equal(iso_state_counter_begin(rig->borrowed.counter, NULL), 0);
    assert_int_equal(iso_audit_renew_anchor(rig->audit, NULL), 0);
    rig->borrowed.audit = rig->audit;
    rig_enrol(rig, "anna", 50);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
    return 0;
}

static int teardown(void **state)
{
    struct rig *rig = *state;
    struct iso_state_counter *counter = rig->borrowed.counter;
    const int error = rig_teardown(state);
    iso_state_counter_free(counter);
    return error;
}

static void visits_are_not_counted_and_orders_are(void **state)
{
    struct rig *rig = *state;
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_not_equal(rig_record(rig, "visit"), "");
    const int before = puppet.increments;
    rig_run(rig, 10000);
    rig_show(rig, 50, 2);
    rig_run(rig, 10000);
    assert_int_equal(puppet.increments, before);
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, NULL), 0);
    assert_int_equal(puppet.increments, before + 1);
}

static void a_change_without_a_record_gets_one(void **state)
{
    struct rig *rig = *state;
    const int before = puppet.increments;
    iso_state_counter_changed(rig->borrowed.counter, ISO_STATE_ADMINISTRATOR);
    rig_run(rig, 1500); /* a record may still be in the queue */
    assert_string_equal(rig_record(rig, "counter"), "");
    rig_run(rig, 2500);
    assert_string_not_equal(rig_record(rig, "counter"), "");
    assert_int_equal(puppet.increments, before + 1);
    const uint64_t last = iso_audit_last(rig->audit);
    rig_run(rig, 10000);
    assert_int_equal(iso_audit_last(rig->audit), last);
    assert_int_equal(puppet.increments, before + 1);
}

static void a_fault_is_reported_until_it_is_over(void **state)
{
    struct rig *rig = *state;
    puppet.error = -EIO;
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, NULL),
                     0); /* the appliance continues */
    rig_run(rig, 100);
    assert_non_null(strstr(rig->warned, "the counter of the state stands still"));
    assert_non_null(strstr(iso_appliance_status(rig->appliance).counter_fault, "the puppet"));
    assert_int_equal(iso_appliance_status(rig->appliance).counter_fault_code, ISO_FAULT_TPM_FAILED);
    assert_non_null(strstr(rig->warned, " [tpm-failed]"));
    puppet.error = 0;
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, NULL), 0);
    rig_run(rig, 100);
    assert_string_equal(iso_appliance_status(rig->appliance).counter_fault, "");
    assert_int_equal(iso_appliance_status(rig->appliance).counter_fault_code, ISO_FAULT_NONE);
    rig_run(rig, 5000);
    assert_false(iso_state_counter_is_due(rig->borrowed.counter));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(visits_are_not_counted_and_orders_are),
        TEST(a_change_without_a_record_gets_one),
        TEST(a_fault_is_reported_until_it_is_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

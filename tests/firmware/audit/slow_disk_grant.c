#include "tests/firmware/audit/slow_disk_story.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/audit/slow_disk_rig.h"
#include "tests/support/devices/wired_door.h"
#include "tests/support/disk/slow_disk.h"

void a_known_person_is_admitted_while_the_disk_works(void **state)
{
    struct rig *rig = *state;
    const char *news = "";
    slow_disk_rig_start(rig);
    for (int i = 0; i < SLOW_DISK_RIG_VISITS_MAX && !strstr(news, "visit allow anna match 2");
         i++) {
        news = slow_disk_rig_visit(
            rig); /* again if the machine woke the log's thread only after 250 ms */
    }
    wired_door_await(ISO_DOOR_RELAY, 2);
    const char *visit = slow_disk_rig_record(rig, "visit");
    assert_non_null(strstr(visit, "\"verdict\":\"allow\",\"door\":\"unlocked\",\"grant\":"));
}

void a_grant_that_is_not_on_record_lets_nobody_in(void **state)
{
    struct rig *rig = *state;
    slow_disk_rig_start(rig);
    do { /* again if the machine woke the log's thread only after 250 ms */
        slow_disk_go_on();
        slow_disk_hang();
        assert_non_null(strstr(slow_disk_rig_visit(rig), "visit deny anna not-on-record 2"));
    } while (slow_disk_waiting() == 0); /* the disk hangs with the record of the grant */
    slow_disk_go_on();
    const char *grant = strstr(slow_disk_rig_record(rig, "grant"), "\"sequence\":");
    assert_non_null(grant);
    char behind[64];
    (void)snprintf(behind, sizeof behind, "\"grant\":%lu,\"reason\":\"not-on-record\"",
                   strtoul(grant + strlen("\"sequence\":"), NULL, 10));
    const char *visit = slow_disk_rig_record(rig, "visit");
    assert_non_null(strstr(visit, "\"verdict\":\"deny\""));
    assert_non_null(strstr(visit, behind));
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 0);
}

/* A grant that waits in the queue behind other records is removed and never written. */
void a_grant_that_was_not_begun_is_forgotten(void **state)
{
    struct rig *rig = *state;
    slow_disk_rig_start(rig);
    slow_disk_rig_hang();
    wired_door_await(ISO_DOOR_RELAY, 2);
    assert_non_null(strstr(slow_disk_rig_visit(rig), "visit deny anna not-on-record 2"));
    slow_disk_go_on();
    assert_string_equal(slow_disk_rig_record(rig, "grant"), "");
    const char *visit = slow_disk_rig_record(rig, "visit");
    assert_non_null(strstr(visit, "\"verdict\":\"deny\",\"reason\":\"not-on-record\""));
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 2);
}

void a_full_queue_lets_nobody_in(void **state)
{
    struct rig *rig = *state;
    const struct iso_audit_record record = iso_audit_record_of("test");
    slow_disk_rig_start(rig);
    slow_disk_rig_hang();
    wired_door_await(ISO_DOOR_RELAY, 2);
    while (iso_audit_writer_post(iso_appliance_log(rig->appliance), &record, NULL) == 0) {
    }
    /* The first grant and its outcome take the places in the queue that are reserved for them. */
    assert_non_null(strstr(slow_disk_rig_visit(rig), "visit deny anna not-on-record 2"));
    assert_non_null(strstr(slow_disk_rig_visit(rig), "visit deny anna not-on-record 2"));
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 2);
    wired_door_press(); /* the exit button still works */
    wired_door_await(ISO_DOOR_RELAY, 4);
    assert_int_equal(slow_disk_waiting(), 1);
    slow_disk_go_on();
    assert_string_equal(slow_disk_rig_record(rig, "grant"), "");
    assert_non_null(strstr(slow_disk_rig_record(rig, "records-lost"), " records\""));
}

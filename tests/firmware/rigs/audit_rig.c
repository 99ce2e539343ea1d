#include "tests/firmware/rigs/audit_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"

static int64_t now_ns = 81250000000;
static int64_t wall_ns = INT64_C(1795250000250000000); /* 2026-11-21T08:33:20.250Z */

const struct iso_times audit_rig_times = {
    .monotonic = {manual_clock_now_ns, &now_ns},
    .wall_ns = manual_clock_now_ns,
    .wall_context = &wall_ns,
};

int audit_rig_try_open(const char *directory, struct iso_audit **out, struct iso_fault *fault)
{
    const struct iso_audit_options options = stores_audit(directory);
    return iso_audit_open(&options, &audit_rig_times, out, fault);
}

struct iso_audit *audit_rig_open(const char *directory)
{
    struct iso_audit *audit = NULL;
    struct iso_fault fault = {.text = ""};
    if (audit_rig_try_open(directory, &audit, &fault)) {
        fail_msg("%s", fault.text);
    }
    return audit;
}

int audit_rig_append(struct iso_audit *audit, const char *event, struct iso_fault *fault)
{
    const struct iso_audit_record record = iso_audit_record_of(event);
    return iso_audit_append(audit, &record, fault);
}

char *audit_rig_log(const char *directory)
{
    struct iso_audit *audit = audit_rig_open(directory);
    char *text = stores_log_text(audit);
    iso_audit_close(audit);
    return text;
}

char *audit_rig_file(const char *directory)
{
    size_t size = 0;
    char *text = scratch_read(scratch_path(directory, "a.log"), &size);
    text[size] = '\0';
    return text;
}

int audit_rig_see(void *context, const char *line)
{
    struct audit_rig_seen *seen = context;
    unsigned sequence = 0;
    assert_int_equal(sscanf(line, "{\"sequence\":%u,", &sequence), 1);
    assert_null(strchr(line, '\n'));
    if (seen->n++ == 0) {
        seen->first = sequence;
    } else {
        assert_int_equal(sequence, seen->last + 1);
    }
    seen->last = sequence;
    return (int)sequence == seen->stop_at ? 7 : 0;
}

struct iso_audit_report audit_rig_verify(struct iso_audit *audit)
{
    struct iso_audit_report report;
    struct iso_fault fault = {.text = ""};
    if (iso_audit_verify(audit, 0, NULL, NULL, &report, &fault)) {
        fail_msg("%s", fault.text);
    }
    return report;
}

const char *audit_rig_line(const char *text, int number)
{
    for (int i = 0; i < number; i++) {
        text += strcspn(text, "\n") + 1;
    }
    return text;
}

struct iso_audit *audit_rig_open_small(const char *directory)
{
    struct iso_audit_options options = stores_audit(directory);
    struct iso_audit *audit = NULL;
    struct iso_fault fault = {.text = ""};
    options.sync = false;
    options.segment_bytes = 2200;
    options.segments = 3;
    if (iso_audit_open(&options, &audit_rig_times, &audit, &fault)) {
        fail_msg("%s", fault.text);
    }
    return audit;
}

/* A clock that shows an earlier time than the newest record of the log. The limits of people are
 * not judged by it. */
#include <errno.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance/appliance_calls.h"
#include "firmware/contract/validity.h"

/* Corrections by the network are smaller. */
static const int64_t tolerance_s = 60;

static int64_t wall_s(const struct iso_appliance *appliance)
{
    return iso_times_wall_ns(&appliance->borrowed.times) / ISO_NS_PER_S;
}

bool iso__appliance_clock_is_behind(const struct iso_appliance *appliance)
{
    return wall_s(appliance) + tolerance_s < iso_audit_latest_s(appliance->borrowed.audit);
}

int64_t iso__appliance_date_s(const struct iso_appliance *appliance)
{
    const int64_t now_s = wall_s(appliance),
                  latest_s = iso_audit_latest_s(appliance->borrowed.audit);
    return now_s < latest_s && !iso__appliance_clock_is_behind(appliance) ? latest_s : now_s;
}

/* Records an event of the clock. `first`: waits for the disk, because the announced act must not
 * happen without the record. */
static bool record(struct iso_appliance *appliance, const char *reason, int64_t before_s,
                   bool first)
{
    struct iso_fault fault = {.text = ""};
    struct iso_audit_record record = iso_audit_record_of("clock");
    char before[ISO_VALIDITY_DATE_SIZE], after[ISO_VALIDITY_DATE_SIZE];
    record.reason = reason;
    record.before = iso_validity_date(before_s, before);
    record.after = iso_validity_date(wall_s(appliance), after);
    return (first ? iso__appliance_record_first(appliance, &record, &fault)
                  : iso__appliance_note(appliance, &record)) == 0;
}

static void tell_behind(struct iso_appliance *appliance)
{
    const int64_t latest_s = iso_audit_latest_s(appliance->borrowed.audit);
    char date[ISO_VALIDITY_DATE_SIZE];
    (void)iso_fault_set_code(&appliance->clock_fault, ISO_FAULT_CLOCK_BEHIND, -ERANGE,
                             "the clock was set back: the log has a record of %s; people with time "
                             "limits are not let in",
                             iso_validity_date(latest_s, date));
    iso__appliance_warn(appliance, &appliance->clock_fault);
    (void)record(appliance, "behind", latest_s, false);
}

static void tell_right(struct iso_appliance *appliance)
{
    appliance->clock_fault.text[0] = '\0';
    iso__appliance_say(appliance, LOG_NOTICE, "the clock is right again");
    (void)record(appliance, "right", iso_audit_latest_s(appliance->borrowed.audit), false);
}

/* A clock that is not set keeps out only people with time limits. */
enum iso_fault_code iso__appliance_clock_code(const struct iso_appliance *appliance)
{
    if (appliance->clock_fault.text[0]) {
        return appliance->clock_fault.code;
    }
    return iso_wall_is_set(wall_s(appliance)) ? ISO_FAULT_NONE : ISO_FAULT_CLOCK_UNSET;
}

void iso__appliance_clock_time(struct iso_appliance *appliance)
{
    const bool behind = iso__appliance_clock_is_behind(appliance);
    const bool told = appliance->clock_fault.text[0] != '\0';
    if (behind && !told) {
        tell_behind(appliance);
    } else if (!behind && told) {
        tell_right(appliance);
    }
}

void iso__appliance_accept_clock(struct iso_appliance *appliance)
{
    if (iso__appliance_clock_is_behind(appliance) &&
        record(appliance, "accepted", iso_audit_latest_s(appliance->borrowed.audit), true)) {
        appliance->clock_fault.text[0] = '\0';
    }
}

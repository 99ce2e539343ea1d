/* The counter of the state directory: a fault of it is told, and a change that no record follows is
 * counted all the same. */
#include <syslog.h>

#include "firmware/appliance/appliance_state.h"
#include "firmware/keys/state_counter.h"

/* Longer than the log takes for a record: the number is due for a moment with each of them. */
static const int64_t patience_ns = 2 * ISO_NS_PER_S;

static void take_news(struct iso_appliance *appliance)
{
    struct iso_fault fault = {.text = ""};
    int error = 0;
    if (!iso_state_counter_take_news(appliance->borrowed.counter, &error, &fault)) {
        return;
    }
    appliance->counter_fault = fault;
    if (error) {
        char tag[ISO_FAULT_TAG_SIZE];
        iso__appliance_say(appliance, LOG_ERR,
                           "the counter of the state stands still, and a restart may be refused: "
                           "%s%s",
                           fault.text, iso_fault_tag(fault.code, tag));
    } else {
        iso__appliance_say(appliance, LOG_NOTICE, "the counter of the state works again");
    }
}

/* A record brings a write of the anchor, and with it the number. It is asked for once. */
static void follow_due(struct iso_appliance *appliance, int64_t now_ns)
{
    if (!iso_state_counter_is_due(appliance->borrowed.counter)) {
        appliance->counter_due = appliance->counter_noted = false;
    } else if (!appliance->counter_due) {
        appliance->counter_due = true;
        appliance->counter_due_ns = now_ns;
    } else if (!appliance->counter_noted && now_ns - appliance->counter_due_ns >= patience_ns) {
        const struct iso_audit_record record = iso_audit_record_of("counter");
        appliance->counter_noted = true;
        (void)iso__appliance_note(appliance, &record);
    }
}

void iso__appliance_counter_time(struct iso_appliance *appliance, int64_t now_ns)
{
    if (appliance->borrowed.counter) {
        take_news(appliance);
        follow_due(appliance, now_ns);
    }
}

/* The reader of cards and keys. */
#include <string.h>
#include <syslog.h>

#include "drivers/door/wiegand.h"
#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"

int iso_appliance_reader_fd(const struct iso_appliance *appliance)
{
    const struct iso_card_source *reader = &appliance->borrowed.reader;
    return reader->take ? reader->fd(reader->context) : -1;
}

/* A card of 26 or 34 bits is known by facility and number, in whatever format a reader sends it. */
static struct iso_card_number number_of(const struct iso_reader_event *event)
{
    struct iso_wiegand_card card;
    if (iso_wiegand_decode(event->bits, event->code, &card) == 0) {
        return (struct iso_card_number){.code = (uint64_t)card.facility << 32 | card.number};
    }
    return (struct iso_card_number){.bits = event->bits, .code = event->code};
}

static void follow_reader_fault(struct iso_appliance *appliance)
{
    const struct iso_card_source *reader = &appliance->borrowed.reader;
    struct iso_fault fault = {.text = ""};
    reader->fault(reader->context, &fault);
    if (strcmp(fault.text, appliance->access.reader_fault.text) == 0) {
        return;
    }
    appliance->access.reader_fault = fault;
    if (*fault.text) {
        iso__appliance_warn(appliance, &fault);
    } else {
        iso__appliance_say(appliance, LOG_NOTICE, "the card reader works again");
    }
}

void iso__appliance_read_cards(struct iso_appliance *appliance)
{
    const struct iso_card_source *reader = &appliance->borrowed.reader;
    struct iso_reader_event event;
    if (!reader->take) {
        return;
    }
    const int64_t oldest_ns = iso_times_now_ns(&appliance->borrowed.times) -
                              appliance->borrowed.config->sensor.stale_ms * ISO_NS_PER_MS;
    while (reader->take(reader->context, &event)) {
        if (event.t_ns < oldest_ns) {
            continue; /* whoever showed it may have left */
        }
        if (event.kind == ISO_READER_KEY) {
            iso_appliance_key(appliance, event.key);
        } else if (event.kind == ISO_READER_CARD) {
            const struct iso_card_number card = number_of(&event);
            iso_appliance_card(appliance, &card);
        }
    }
    explicit_bzero(&event, sizeof event);
    follow_reader_fault(appliance);
}

void iso__appliance_show_at_reader(const struct iso_appliance *appliance, bool allow)
{
    const struct iso_card_source *reader = &appliance->borrowed.reader;
    if (reader->take && reader->show) {
        reader->show(reader->context, allow);
    }
}

const char *iso__appliance_reader_state(const struct iso_appliance *appliance)
{
    if (!appliance->borrowed.reader.take) {
        return "off";
    }
    return *appliance->access.reader_fault.text ? "lost" : "works";
}

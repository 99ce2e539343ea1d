/* The method RecordCommission: the checks of a door before it goes into service are put on record.
 */
#include <string.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/person_name.h"

enum { WHO_SIZE = 64 };

/* The items of a call. Their texts point into it. */
struct items {
    struct iso_commission_item list[ISO_CONTRACT_ITEMS_MAX];
    size_t n;
};

/* All texts go into the log, so they contain nothing that could look like something else there. A
 * remark may be any text of people, because it is the last thing in its record. */
static int check_item(const struct iso_commission_item *item, sd_bus_error *out)
{
    if (!iso__bus_is_word(item->item, ISO_CONTRACT_ITEM_BYTES)) {
        return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                 "an item is a word of small letters, digits, '.', '-' and '_', at "
                                 "most %d bytes long",
                                 ISO_CONTRACT_ITEM_BYTES);
    }
    if (strlen(item->remark) > ISO_CONTRACT_REMARK_BYTES ||
        iso_person_name_has_control(item->remark)) {
        return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                 "%s: a remark is one line of at most %d bytes", item->item,
                                 ISO_CONTRACT_REMARK_BYTES);
    }
    return 0;
}

static int read_items(sd_bus_message *call, struct items *items, sd_bus_error *out)
{
    struct iso_commission_item item;
    int r = sd_bus_message_enter_container(call, 'a', "(sss)");
    while (r >= 0 &&
           (r = sd_bus_message_read(call, "(sss)", &item.item, &item.answer, &item.remark)) > 0) {
        if (items->n == ISO_CONTRACT_ITEMS_MAX) {
            return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                     "there are more than %d items", ISO_CONTRACT_ITEMS_MAX);
        }
        r = check_item(&item, out);
        items->list[items->n++] = item;
    }
    return r < 0 ? r : sd_bus_message_exit_container(call);
}

int iso__bus_record_commission(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct items items = {.n = 0};
    struct iso_fault fault = {.text = ""};
    const char *by = NULL, *outcome = NULL;
    char who[WHO_SIZE];
    uint64_t sequence = 0;
    int r = sd_bus_message_read(call, "s", &by);
    if (r < 0) {
        return r;
    }
    const char *flaw = iso_person_name_flaw(by);
    r = flaw ? sd_bus_error_set(out, ISO_CONTRACT_ERROR_INVALID_NAME, flaw)
             : read_items(call, &items, out);
    if (r < 0) {
        return r;
    }
    iso__bus_describe_caller(call, who, sizeof who);
    const struct iso_commission commission = {
        .by = by, .who = who, .items = items.list, .n = items.n};
    r = iso_appliance_record_commission(bus->appliance, &commission, &outcome, &sequence, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault)
                 : sd_bus_reply_method_return(call, "st", outcome, sequence);
}

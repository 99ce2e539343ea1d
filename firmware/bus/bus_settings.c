/* The methods that list the configuration of the appliance and change it. */
#include "firmware/appliance/administration/administration.h"
#include "firmware/bus/bus_state.h"
#include "firmware/config/settings.h"

/* Names of files and devices may contain bytes that the bus does not accept. */
enum { CLEAN_SIZE = 4 + ISO_CONFIG_TEXT_SIZE };

/* ---- the list ---- */

struct list {
    sd_bus_message *reply;
    const struct iso_live_settings *live; /* NULL: no setting can be changed */
};

static int append_setting(void *context, const struct iso_setting *setting)
{
    const struct list *list = context;
    const struct iso_config_key *key = list->live
                                           ? iso_live_key_find(setting->section, setting->key)
                                           : NULL;
    char value[CLEAN_SIZE], configured[ISO_LIVE_VALUE_SIZE] = "";
    iso__bus_clean_text(value, sizeof value, setting->value);
    if (key) {
        iso_live_key_print(&list->live->configured, key, configured);
    }
    return sd_bus_message_append(list->reply, "(ssssssbs)", setting->section, setting->key, value,
                                 setting->standard, setting->range, setting->help, key != NULL,
                                 key ? configured : value);
}

int iso__bus_get_settings(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct list list = {.live = bus->borrowed->settings};
    int r = sd_bus_message_new_method_return(call, &list.reply);
    (void)out;
    if (r >= 0) {
        r = sd_bus_message_open_container(list.reply, 'a', "(ssssssbs)");
    }
    if (r >= 0) {
        r = iso_config_visit_settings(bus->borrowed->config, append_setting, &list);
    }
    return iso__bus_send_reply(list.reply, r < 0 ? r : sd_bus_message_close_container(list.reply));
}

/* ---- changes ---- */

static int change(sd_bus_message *call, const struct iso_bus *bus,
                  const struct iso_setting_request *wish, sd_bus_error *out)
{
    struct iso_setting_request request = *wish;
    struct iso_fault fault = {.text = ""};
    char who[64], value[ISO_LIVE_VALUE_SIZE];
    iso__bus_describe_caller(call, who, sizeof who);
    request.who = who;
    const int r = iso_appliance_set_setting(bus->appliance, &request, value, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, "s", value);
}

int iso__bus_set_setting(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_setting_request request = {.value = NULL};
    const int r = sd_bus_message_read(call, "sss", &request.section, &request.key, &request.value);
    return r < 0 ? r : change(call, context, &request, out);
}

int iso__bus_reset_setting(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_setting_request request = {.value = NULL};
    const int r = sd_bus_message_read(call, "ss", &request.section, &request.key);
    return r < 0 ? r : change(call, context, &request, out);
}

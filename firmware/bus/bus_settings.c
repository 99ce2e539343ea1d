/* The method that lists the configuration of the appliance. */
#include "firmware/bus/bus_state.h"
#include "firmware/config/settings.h"

/* Names of files and devices may contain bytes that the bus does not accept. */
enum { CLEAN_SIZE = 4 + ISO_CONFIG_TEXT_SIZE };

static int append_setting(void *context, const struct iso_setting *setting)
{
    char value[CLEAN_SIZE];
    iso__bus_clean_text(value, sizeof value, setting->value);
    return sd_bus_message_append(context, "(ssssss)", setting->section, setting->key, value,
                                 setting->standard, setting->range, setting->help);
}

int iso__bus_get_settings(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    sd_bus_message *reply = NULL;
    int r = sd_bus_message_new_method_return(call, &reply);
    (void)out;
    if (r >= 0) {
        r = sd_bus_message_open_container(reply, 'a', "(ssssss)");
    }
    if (r >= 0) {
        r = iso_config_visit_settings(bus->borrowed->config, append_setting, reply);
    }
    return iso__bus_send_reply(reply, r < 0 ? r : sd_bus_message_close_container(reply));
}

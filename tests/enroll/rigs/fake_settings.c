/* Four settings, one of which was changed while the daemon ran. */
#include <errno.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_service.h"

int fake_on_get_settings(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    return sd_bus_reply_method_return(
        call, "a(ssssssbs)", 4, "door", "backend", "gpiod", "null", "",
        "driver of the door's lines", 0, "gpiod", "door", "unlock_ms", "7000", "4000",
        "a whole number, 100 to 600000", "how long the door stays unlocked", 1, "5000", "decision",
        "level", "balanced", "balanced", "convenient|balanced|strict", "share of the visits", 1,
        "balanced", "decision", "margin", "0", "0", "a number, 0 to 100",
        "score by which the best person must lead", 1, "0");
}

int fake_on_set_setting(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const char *section, *key, *value;
    const int r = sd_bus_message_read(call, "sss", &section, &key, &value);
    if (r < 0 || fake_fails(service, call, error)) {
        return r < 0 ? r : -EIO;
    }
    const char *const words[] = {" ", section, " ", key, " ", value};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        fake_trace(service, words[i]);
    }
    return sd_bus_reply_method_return(call, "s", value);
}

int fake_on_reset_setting(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    return fake_fails(service, call, error) ? -EIO : sd_bus_reply_method_return(call, "s", "5000");
}

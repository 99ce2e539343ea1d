#include "enroll/cli/client/bus.h"

#include <stddef.h>

int cli_bus_connect(const struct cli_bus *bus, sd_bus **out)
{
    sd_bus *made = NULL;
    int r;

    if (!bus->address) {
        return bus->session ? sd_bus_open_user(out) : sd_bus_open_system(out);
    }
    r = sd_bus_new(&made);
    if (r < 0) {
        return r;
    }
    r = sd_bus_set_address(made, bus->address);
    if (r >= 0) {
        r = sd_bus_set_bus_client(made, 1);
    }
    if (r >= 0) {
        r = sd_bus_start(made);
    }
    if (r < 0) {
        sd_bus_unref(made);
        return r;
    }
    *out = made;
    return 0;
}

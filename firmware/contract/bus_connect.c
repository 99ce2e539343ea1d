#include "firmware/contract/bus_connect.h"

#include <string.h>

int iso_bus_connect(const char *address, sd_bus **out)
{
    sd_bus *made = NULL;
    if (strcmp(address, "system") == 0) {
        return sd_bus_open_system(out);
    }
    if (strcmp(address, "session") == 0) {
        return sd_bus_open_user(out);
    }
    int r = sd_bus_new(&made);
    if (r >= 0) {
        r = sd_bus_set_address(made, address);
    }
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

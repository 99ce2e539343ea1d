#include "enroll/cli/client/bus.h"

#include "firmware/contract/bus_connect.h"

int cli_bus_connect(const struct cli_bus *bus, sd_bus **out)
{
    const char *standard = bus->session ? "session" : "system";
    return iso_bus_connect(bus->address ? bus->address : standard, out);
}

/* The messages of a hub for fuzz_bus.c. Bytes of the input alone would never pass a signature, so
 * most messages are signed with the hub's key. */
#include <sys/mman.h>
#include <unistd.h>

#include "tests/fuzz/firmware/bus_clients.h"
#include "tests/fuzz/fuzz.h"

enum { ZONES = 2, PEOPLE = 4, BYTES_MAX = 256, FIRST_FACE = 80 /* of nobody whom the rig shows */ };

static struct iso_fleet_bytes person(struct door_rig *hub, struct bus_input *input)
{
    static const char *const names[] = {"ada", "bob", "anna", ""};
    const int zone = (int)(bus_input_take(input, 1) % ZONES);
    const int who = (int)(bus_input_take(input, 1) % PEOPLE);
    const uint64_t revision = bus_input_take(input, 1);
    const uint64_t how = bus_input_take(input, 1);
    return how % 4 == 0 ? door_rig_remove(hub, zone, who, revision)
                        : door_rig_put(hub, zone, who, revision, names[how / 4 % 4],
                                       how & 16 ? FIRST_FACE + who : 0, how & 32);
}

static struct iso_fleet_bytes rule(struct door_rig *hub, struct bus_input *input)
{
    static const char *const policies[] = {"{}", "{\"rules\":[]}", "[", ""};
    const int zone = (int)(bus_input_take(input, 1) % ZONES);
    const uint64_t how = bus_input_take(input, 1);
    return how & 1 ? door_rig_lock(hub, zone, how & 2)
                   : door_rig_policy(hub, zone, policies[how / 2 % 4]);
}

static struct iso_fleet_bytes rest(struct bus_input *input)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    const size_t n = bus_input_take(input, 1) % BYTES_MAX;
    for (size_t i = 0; i < n; i++) {
        const uint8_t byte = (uint8_t)bus_input_take(input, 1);
        iso_fleet_put(&out, &byte, 1);
    }
    return out;
}

static bool is_member(const struct door_rig *hub)
{
    struct iso_fleet_status status;
    return iso_fleet_get_status(hub->fleet, &status, NULL) == 0;
}

/* A door that has not joined asks for no lease. */
static struct iso_fleet_bytes whole_message(struct door_rig *hub, struct bus_input *input)
{
    switch (bus_input_take(input, 1) % 8) {
    case 0:
        return rest(input);
    case 1:
        return door_rig_membership(hub);
    case 2:
    case 3:
        return is_member(hub) ? door_rig_lease(hub, bus_input_take(input, 1) % (ZONES + 1))
                              : door_rig_membership(hub);
    case 4:
        return door_rig_key(hub, (int)(bus_input_take(input, 1) % ZONES));
    case 5:
        return rule(hub, input);
    default:
        return person(hub, input);
    }
}

struct iso_fleet_bytes bus_hub_message(struct door_rig *hub, struct bus_input *input)
{
    struct iso_fleet_bytes message = whole_message(hub, input);
    const uint64_t change = bus_input_take(input, 1);
    if (change % 4 == 3 && message.size > 0) {
        message.bytes[bus_input_take(input, 2) % message.size] ^= (uint8_t)(change | 1);
    }
    return message;
}

int bus_hub_file(struct door_rig *hub, struct bus_input *input)
{
    struct iso_fleet_bytes one = {.bytes = NULL}, file;
    const uint64_t how = bus_input_take(input, 1);
    const int fd = memfd_create("snapshot", MFD_CLOEXEC);
    if (how & 1) {
        one = door_rig_change((int)(how / 4 % PEOPLE), how / 16, "ada", how & 2 ? FIRST_FACE : 0);
        file = door_rig_snapshot(hub, (int)(how / 2 % ZONES), &one, 1);
    } else {
        file = bus_hub_message(hub, input);
    }
    fuzz_check(fd >= 0 &&
                   (file.size == 0 || write(fd, file.bytes, file.size) == (ssize_t)file.size),
               "a file in memory");
    iso_fleet_bytes_free(&file);
    return fd;
}

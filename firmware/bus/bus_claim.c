/* The claim of a client: the methods Claim and Release, and the end of the claim. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"

void iso__bus_forget_claimant(struct iso_bus *bus)
{
    bus->track = sd_bus_track_unref(bus->track);
    bus->claimant[0] = '\0';
    iso__bus_end_login(bus);
    iso__bus_end_relief(bus);
}

static int on_claimant_gone(sd_bus_track *track, void *context)
{
    struct iso_bus *bus = context;
    (void)track;
    iso_appliance_release(bus->appliance);
    iso__bus_forget_claimant(bus);
    return 0;
}

int iso__bus_require_claim(const struct iso_bus *bus, sd_bus_message *call, sd_bus_error *out)
{
    if (!bus->claimant[0]) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_CLAIM_DEVICE, "claim the camera first");
    }
    if (strcmp(bus->claimant, sd_bus_message_get_sender(call)) != 0) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_ALREADY_IN_USE,
                                "another client has the camera");
    }
    if (bus->login.on) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_CLAIM_DEVICE,
                                "this client has the camera for a login alone");
    }
    return 0;
}

int iso__bus_require_free(const struct iso_bus *bus, sd_bus_message *call, sd_bus_error *out)
{
    if (bus->claimant[0]) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_ALREADY_IN_USE,
                                strcmp(bus->claimant, sd_bus_message_get_sender(call)) == 0
                                    ? "this client has the camera already"
                                    : "another client has the camera");
    }
    return 0;
}

int iso__bus_track_claimant(struct iso_bus *bus, sd_bus_message *call)
{
    int r = sd_bus_track_new(bus->bus, &bus->track, on_claimant_gone, bus);
    if (r >= 0) {
        r = sd_bus_track_add_sender(bus->track, call);
    }
    if (r < 0) {
        bus->track = sd_bus_track_unref(bus->track);
    }
    return r;
}

void iso__bus_note_claimant(struct iso_bus *bus, sd_bus_message *call)
{
    (void)snprintf(bus->claimant, sizeof bus->claimant, "%s", sd_bus_message_get_sender(call));
}

int iso__bus_claim(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    int r = iso__bus_require_free(bus, call, out);
    if (r >= 0) {
        r = iso__bus_track_claimant(bus, call);
    }
    if (r < 0) {
        return r;
    }
    r = iso_appliance_claim(bus->appliance);
    if (r < 0) {
        bus->track = sd_bus_track_unref(bus->track);
        return r;
    }
    iso__bus_note_claimant(bus, call);
    return sd_bus_reply_method_return(call, NULL);
}

int iso__bus_release(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    const int r = iso__bus_require_claim(bus, call, out);
    if (r < 0) {
        return r;
    }
    iso_appliance_release(bus->appliance);
    iso__bus_forget_claimant(bus);
    return sd_bus_reply_method_return(call, NULL);
}

/* The method Picture. Its call is answered when the next frame arrives. */
#include <errno.h>
#include <unistd.h>

#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"
#include "firmware/recognise/relief_picture.h"

int iso__bus_picture(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    int r = iso__bus_require_claim(bus, call, out);
    if (r < 0) {
        return r;
    }
    r = iso_appliance_picture(bus->appliance, &fault);
    if (r < 0) {
        return iso__bus_refuse(out, r, &fault);
    }
    bus->picture = sd_bus_message_ref(call);
    return 1; /* the answer follows later */
}

static int reply_error(sd_bus_message *call, int error, const struct iso_fault *fault)
{
    sd_bus_error reply = SD_BUS_ERROR_NULL;
    (void)iso__bus_refuse(&reply, error, fault);
    const int r = sd_bus_reply_method_error(call, &reply);
    sd_bus_error_free(&reply);
    return r;
}

/* The reply fails if the client has left the bus. This is ignored, because nothing depends on the
 * reply. */
void iso__bus_on_picture(void *context, const struct iso_frame *frame)
{
    struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const int fd = frame
                       ? iso_relief_picture_file(frame, &fault)
                       : iso_fault_set(&fault, -ENODEV,
                                       "no picture: the camera shows nothing, or the claim ended");
    if (bus->picture) {
        int r = fd < 0 ? fd : sd_bus_reply_method_return(bus->picture, "h", fd);
        if (r < 0) {
            /* There is no file, or the client cannot receive one. */
            (void)reply_error(bus->picture, r, &fault);
        }
    }
    bus->picture = sd_bus_message_unref(bus->picture);
    if (fd >= 0) {
        (void)close(fd);
    }
}

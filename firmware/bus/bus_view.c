/* What the sensor sees, for clients that help to aim it: the signal View, and a part of
 * GetStatus. */
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"

/* ---- words and numbers ---- */

struct entry {
    const char *key;
    double value;
};

static int append_numbers(sd_bus_message *message, const struct entry *entries, size_t n)
{
    int r = 0;
    for (size_t i = 0; r >= 0 && i < n; i++) {
        r = sd_bus_message_append(message, "{sv}", entries[i].key, "d", entries[i].value);
    }
    return r;
}

int iso__bus_append_view_entries(sd_bus_message *message, const struct iso_view *view)
{
    const struct entry pose[] = {
        {"distance-mm", view->distance_mm},
        {"right-mm", view->right_mm},
        {"down-mm", view->down_mm},
        {"yaw-deg", view->yaw_rad / ISO_RAD_PER_DEG},
        {"pitch-deg", view->pitch_rad / ISO_RAD_PER_DEG},
        {"roll-deg", view->roll_rad / ISO_RAD_PER_DEG},
    };
    const struct entry fit[] = {
        {"residual-mm", view->residual_mm}, {"fit-coverage", view->fit_coverage},
        {"coverage", view->coverage},       {"landmark-sigma-mm", view->sigma_mm},
        {"expression", view->expression},
    };
    const struct entry motion[] = {
        {"speed-mm-s", view->mm_s},
        {"speed-deg-s", view->rad_s / ISO_RAD_PER_DEG},
    };
    int r = sd_bus_message_append(message, "{sv}", "capture", "s", iso_capture_name(view->capture));
    r = r < 0 || !view->posed ? r : append_numbers(message, pose, sizeof pose / sizeof *pose);
    r = r < 0 || !view->fitted ? r : append_numbers(message, fit, sizeof fit / sizeof *fit);
    return r < 0 || !view->tracked
               ? r
               : append_numbers(message, motion, sizeof motion / sizeof *motion);
}

int iso__bus_append_view(sd_bus_message *message, const struct iso_view *view)
{
    int r = sd_bus_message_open_container(message, 'a', "{sv}");
    if (r >= 0) {
        r = iso__bus_append_view_entries(message, view);
    }
    return r < 0 ? r : sd_bus_message_close_container(message);
}

/* ---- the listeners ---- */

/* Called when the last listener has stopped or left the bus, and again as long as the list exists
 * and is empty. */
static int on_nobody_aims(sd_bus_track *track, void *context)
{
    struct iso_bus *bus = context;
    (void)track;
    iso_appliance_aim(bus->appliance, false);
    bus->aiming = sd_bus_track_unref(bus->aiming);
    return 0;
}

int iso__bus_aim_start(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    (void)out;
    int r = bus->aiming ? 0 : sd_bus_track_new(bus->bus, &bus->aiming, on_nobody_aims, bus);
    if (r >= 0) {
        r = sd_bus_track_add_sender(bus->aiming, call);
    }
    if (r < 0) {
        return r;
    }
    iso_appliance_aim(bus->appliance, true);
    return sd_bus_reply_method_return(call, NULL);
}

int iso__bus_aim_stop(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    const int r = bus->aiming ? sd_bus_track_remove_sender(bus->aiming, call) : 0;
    if (r == 0) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_NO_ACTION, "this client does not aim");
    }
    return r < 0 ? r : sd_bus_reply_method_return(call, NULL);
}

void iso__bus_on_view(void *context, const struct iso_view *view)
{
    const struct iso_bus *bus = context;
    for (const char *name = sd_bus_track_first(bus->aiming); name;
         name = sd_bus_track_next(bus->aiming)) {
        sd_bus_message *signal = NULL;
        int r = iso__bus_new_signal(bus, ISO_CONTRACT_VIEW, &signal);
        if (r >= 0) {
            r = iso__bus_append_view(signal, view);
        }
        iso__bus_send_signal(signal, name, r);
    }
}

/* Aiming: the View signals of the script. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_service.h"

static int send_view(sd_bus_message *call, const struct fake_view *view)
{
    sd_bus_message *signal = NULL;
    int r = sd_bus_message_new_signal(sd_bus_message_get_bus(call), &signal, ISO_CONTRACT_PATH,
                                      ISO_CONTRACT_INTERFACE, "View");

    if (r >= 0) {
        r = sd_bus_message_open_container(signal, 'a', "{sv}");
    }
    if (r >= 0) {
        r = sd_bus_message_append(signal, "{sv}", "capture", "s", view->capture);
    }
    if (r >= 0 && !isnan(view->distance_mm)) {
        r = sd_bus_message_append(signal, "{sv}", "distance-mm", "d", view->distance_mm);
    }
    if (r >= 0 && !isnan(view->yaw_deg)) {
        r = sd_bus_message_append(signal, "{sv}", "yaw-deg", "d", view->yaw_deg);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(signal);
    }
    if (r >= 0) {
        r = sd_bus_send_to(sd_bus_message_get_bus(call), signal, sd_bus_message_get_sender(call),
                           NULL);
    }
    sd_bus_message_unref(signal);
    return r;
}

int fake_on_aim_start(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_reply_method_return(call, NULL);
    (void)snprintf(service->action, sizeof service->action, "Aim");
    for (size_t i = 0; r >= 0 && i < service->script->n_views; i++) {
        r = send_view(call, &service->script->views[i]);
    }
    service->leave = service->script->vanish;
    return r;
}

/* AimStop needs no claim, but an AimStart before it. */
int fake_on_aim_stop(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    if (strcmp(service->action, "Aim") != 0) {
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_NO_ACTION, "nothing to stop");
    }
    service->action[0] = '\0';
    return sd_bus_reply_method_return(call, NULL);
}

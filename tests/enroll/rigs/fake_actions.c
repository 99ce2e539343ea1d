/* Actions in front of the camera: claims, starts, the status signals of the script, and pictures.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_service.h"

int fake_on_claim(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    if (service->claimed_by[0]) {
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_ALREADY_IN_USE, "claimed");
    }
    (void)snprintf(service->claimed_by, sizeof service->claimed_by, "%s",
                   sd_bus_message_get_sender(call));
    return sd_bus_reply_method_return(call, NULL);
}

int fake_on_release(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;

    if (fake_fails(service, call, error) || !fake_is_claimant(service, call, error)) {
        return -EIO;
    }
    service->claimed_by[0] = '\0';
    return sd_bus_reply_method_return(call, NULL);
}

/* Sends EnrollStep for a status "step-...", only to the client that has the claim. */
static int send_step(sd_bus *bus, const struct fake_service *service,
                     const struct fake_status *status)
{
    sd_bus_message *signal = NULL;
    int r = sd_bus_message_new_signal(bus, &signal, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                      ISO_CONTRACT_ENROLL_STEP);

    if (r >= 0) {
        r = sd_bus_message_append(signal, "ssuud", status->person, status->result + strlen("step-"),
                                  status->stage, status->stages, status->value);
    }
    if (r >= 0) {
        r = sd_bus_send_to(bus, signal, service->claimed_by, NULL);
    }
    sd_bus_message_unref(signal);
    return r;
}

/* Sends a status signal only to the client that has the claim, as the daemon does. */
static int send_status(sd_bus *bus, const struct fake_service *service,
                       const struct fake_status *status)
{
    const char *person = status->person ? status->person : "";
    sd_bus_message *signal = NULL;
    char member[32];

    if (strncmp(status->result, "step-", strlen("step-")) == 0) {
        return send_step(bus, service, status);
    }
    (void)snprintf(member, sizeof member, "%sStatus", service->action);
    int r = sd_bus_message_new_signal(bus, &signal, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                      member);
    if (r >= 0 && strcmp(service->action, "Enroll") == 0) {
        r = sd_bus_message_append(signal, "sbuuds", status->result, (int)status->done,
                                  status->stage, status->stages, status->value, person);
    } else if (r >= 0) {
        r = sd_bus_message_append(signal, "sbsdd", status->result, (int)status->done, person,
                                  status->value, status->threshold);
    }
    if (r >= 0) {
        r = sd_bus_send_to(bus, signal, service->claimed_by, NULL);
    }
    sd_bus_message_unref(signal);
    return r;
}

static void send_strange_status(const struct fake_service *service)
{
    const struct fake_status status = {.result = service->script->stranger, .done = true};
    const char *name;
    sd_bus *bus = NULL;

    if (fake_open_bus(service->address, &bus) >= 0 && sd_bus_get_unique_name(bus, &name) >= 0) {
        send_status(bus, service, &status);
    }
    sd_bus_flush_close_unref(bus);
}

/* Answers a Start method. `enrolled` is the name of an enrolment, NULL for the other actions. If a
 * person of the script has this name, the answer describes that person. */
static int answer_start(const struct fake_service *service, sd_bus_message *call,
                        const char *enrolled)
{
    const struct fake_person *known = enrolled ? fake_find_person(service, enrolled) : NULL;

    if (known) {
        return sd_bus_reply_method_return(call, "a{sv}", 6, "person", "s", known->name, "enrolled",
                                          "x", known->enrolled, "templates", "u", known->templates,
                                          "valid-from", "x", known->valid_from, "valid-until", "x",
                                          known->valid_until, "of-later", "b", 1);
    }
    return enrolled ? sd_bus_reply_method_return(call, "a{sv}", 0)
                    : sd_bus_reply_method_return(call, NULL);
}

/* `enrolled`: the person to enrol; NULL for the other actions. */
static int start_action(struct fake_service *service, sd_bus_message *call, const char *action,
                        const char *enrolled)
{
    const struct fake_script *script = service->script;
    int r = answer_start(service, call, enrolled);

    (void)snprintf(service->action, sizeof service->action, "%s", action);
    if (script->stranger) {
        send_strange_status(service);
    }
    for (size_t i = 0; r >= 0 && i < script->n_statuses; i++) {
        r = send_status(sd_bus_message_get_bus(call), service, &script->statuses[i]);
    }
    service->leave = script->vanish;
    return r;
}

int fake_on_enroll_start(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;
    const char *person;

    if (fake_fails(service, call, error) || !fake_is_claimant(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_message_read_basic(call, 's', &person);
    if (r < 0) {
        return r;
    }
    fake_trace(service, " ");
    fake_trace(service, person);
    r = fake_trace_options(service, call);
    return r < 0 ? r : start_action(service, call, "Enroll", person);
}

int fake_on_verify_start(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;
    const char *person;

    if (fake_fails(service, call, error) || !fake_is_claimant(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read_basic(call, 's', &person);
    if (r < 0) {
        return r;
    }
    fake_trace(service, " ");
    fake_trace(service, person);
    return start_action(service, call, "Verify", NULL);
}

int fake_on_identify_start(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;

    if (fake_fails(service, call, error) || !fake_is_claimant(service, call, error)) {
        return -EIO;
    }
    return start_action(service, call, "Identify", NULL);
}

int fake_on_stop(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;
    const size_t length = strlen(service->action);

    if (fake_fails(service, call, error) || !fake_is_claimant(service, call, error)) {
        return -EIO;
    }
    if (length == 0 || strncmp(sd_bus_message_get_member(call), service->action, length) != 0) {
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_NO_ACTION, "nothing to stop");
    }
    service->action[0] = '\0';
    return sd_bus_reply_method_return(call, NULL);
}

int fake_on_picture(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;
    const char *bytes = service->script->picture ? service->script->picture : "PNG";

    if (fake_fails(service, call, error) || !fake_is_claimant(service, call, error)) {
        return -EIO;
    }
    const int fd = memfd_create("picture", MFD_CLOEXEC);
    const size_t given = service->script->picture_size, size = given ? given : strlen(bytes);
    const bool made = fd >= 0 && write(fd, bytes, size) == (ssize_t)size;
    const int r = made ? sd_bus_reply_method_return(call, "h", fd) : -EIO;
    if (fd >= 0) {
        close(fd);
    }
    return r;
}

/* The people of the script. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <strings.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_service.h"

/* Returns NULL if no person has this name. */
const struct fake_person *fake_find_person(const struct fake_service *service, const char *name)
{
    for (size_t i = 0; i < service->script->n_people; i++) {
        if (strcasecmp(name, service->script->people[i].name) == 0) {
            return &service->script->people[i];
        }
    }
    return NULL;
}

int fake_trace_options(const struct fake_service *service, sd_bus_message *call)
{
    const char *name, *type;
    char text[128], container;
    int r = sd_bus_message_enter_container(call, 'a', "{sv}");

    while (r >= 0 && (r = sd_bus_message_enter_container(call, 'e', "sv")) > 0) {
        int64_t number = 0;
        int boolean = 0;
        r = sd_bus_message_read_basic(call, 's', &name);
        if (r >= 0) {
            r = sd_bus_message_peek_type(call, &container, &type);
        }
        if (r >= 0 && *type == 'b') {
            r = sd_bus_message_read(call, "v", "b", &boolean);
            number = boolean;
        } else if (r >= 0) {
            r = sd_bus_message_read(call, "v", "x", &number);
        }
        if (r >= 0) {
            r = sd_bus_message_exit_container(call);
        }
        (void)snprintf(text, sizeof text, " %s=%" PRId64, r < 0 ? "?" : name, number);
        fake_trace(service, text);
    }
    return r;
}

int fake_on_list(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;
    sd_bus_message *reply = NULL;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_message_new_method_return(call, &reply);
    if (r >= 0) {
        r = sd_bus_message_open_container(reply, 'a', "(sxxxu)");
    }
    for (size_t i = 0; r >= 0 && i < service->script->n_people; i++) {
        const struct fake_person *person = &service->script->people[i];
        r = sd_bus_message_append(reply, "(sxxxu)", person->name, person->enrolled,
                                  person->valid_from, person->valid_until, person->templates);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(reply);
    }
    if (r >= 0) {
        r = sd_bus_send(NULL, reply, NULL);
    }
    sd_bus_message_unref(reply);
    return r;
}

static int no_such_person(sd_bus_error *error, const char *name)
{
    return sd_bus_error_setf(error, ISO_CONTRACT_ERROR_NO_SUCH_PERSON, "%s: no such person", name);
}

int fake_on_delete(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const char *name;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read_basic(call, 's', &name);
    if (r < 0) {
        return r;
    }
    if (!fake_find_person(service, name)) {
        return no_such_person(error, name);
    }
    return sd_bus_reply_method_return(call, NULL);
}

int fake_on_set_validity(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const char *name;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_message_read_basic(call, 's', &name);
    if (r < 0) {
        return r;
    }
    fake_trace(service, " ");
    fake_trace(service, name);
    r = fake_trace_options(service, call);
    if (r < 0) {
        return r;
    }
    const struct fake_person *known = fake_find_person(service, name);
    if (!known) {
        return no_such_person(error, name);
    }
    return sd_bus_reply_method_return(call, "sxx", known->name, known->valid_from,
                                      known->valid_until);
}

int fake_on_rename(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const char *name, *to;
    const char *remark = service->script->remark ? service->script->remark : "";

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read(call, "ss", &name, &to);
    if (r < 0) {
        return r;
    }
    if (!fake_find_person(service, name)) {
        return no_such_person(error, name);
    }
    return sd_bus_reply_method_return(call, "s", remark);
}

/* The methods that list people, delete a person, and change a person's data other than the
 * templates. Also the answer of EnrollStart for a name that is in use. */
#include <errno.h>
#include <string.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"

/* ---- options ---- */

int iso__bus_read_validity_option(sd_bus_message *call, const char *name,
                                  struct iso_validity_change *change)
{
    int r, flag = 0;
    if (strcmp(name, ISO_CONTRACT_VALID_FROM) == 0) {
        change->names_from = true;
        r = sd_bus_message_read(call, "v", "x", &change->limits.from_s);
    } else if (strcmp(name, ISO_CONTRACT_VALID_UNTIL) == 0) {
        change->names_until = true;
        r = sd_bus_message_read(call, "v", "x", &change->limits.until_s);
    } else if (strcmp(name, ISO_CONTRACT_EXPIRED) == 0) {
        r = sd_bus_message_read(call, "v", "b", &flag);
        change->expired = flag != 0;
    } else {
        return 0;
    }
    return r < 0 ? r : 1;
}

int iso__bus_refuse_option(sd_bus_error *out, int r, const char *name)
{
    if (r == 0) {
        return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT, "unknown option '%s'",
                                 name);
    }
    return r == -ENXIO ? sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                           "option '%s' is of another type", name)
                       : r;
}

static int read_changes(sd_bus_message *call, struct iso_validity_change *change, sd_bus_error *out)
{
    const char *name;
    int r = sd_bus_message_enter_container(call, 'a', "{sv}");
    while (r >= 0 && (r = sd_bus_message_enter_container(call, 'e', "sv")) > 0) {
        r = sd_bus_message_read_basic(call, 's', &name);
        if (r < 0) {
            return r;
        }
        r = iso__bus_read_validity_option(call, name, change);
        if (r <= 0) {
            return iso__bus_refuse_option(out, r, name);
        }
        r = sd_bus_message_exit_container(call);
    }
    return r;
}

/* ---- methods ---- */

int iso__bus_set_validity(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct iso_validity_change change = {0};
    struct iso_fault fault = {.text = ""};
    const char *person;
    int r = sd_bus_message_read(call, "s", &person);
    if (r >= 0) {
        r = read_changes(call, &change, out);
    }
    if (r < 0) {
        return r;
    }
    if (!change.names_from && !change.names_until) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT, "no limit is given");
    }
    r = iso_appliance_set_validity(bus->appliance, person, &change, &fault);
    if (r < 0) {
        return iso__bus_refuse(out, r, &fault);
    }
    const struct iso_person *known = iso_gallery_find(bus->borrowed->gallery, person);
    return sd_bus_reply_method_return(call, "sxx", known->name, known->valid_from_s,
                                      known->valid_until_s);
}

int iso__bus_rename(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const char *person, *name, *remark = "";
    int r = sd_bus_message_read(call, "ss", &person, &name);
    if (r < 0) {
        return r;
    }
    const char *flaw = iso_person_name_flaw(name);
    if (flaw) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_INVALID_NAME, flaw);
    }
    r = iso_appliance_rename(bus->appliance, person, name, &remark, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, "s", remark);
}

/* ---- the list, and deleting ---- */

int iso__bus_reply_list(sd_bus_message *call, const struct iso_bus *bus, iso__bus_append_fn append,
                        sd_bus_error *out)
{
    sd_bus_message *reply = NULL;
    struct iso_fault fault = {.text = ""};
    int r = iso_gallery_state(bus->borrowed->gallery, &fault);
    if (r < 0) {
        return iso__bus_refuse(out, r, &fault);
    }
    r = sd_bus_message_new_method_return(call, &reply);
    return iso__bus_send_reply(reply, r < 0 ? r : append(reply, bus));
}

static int append_people(sd_bus_message *reply, const struct iso_bus *bus)
{
    size_t n = 0;
    const struct iso_person *people = iso_gallery_people(bus->borrowed->gallery, &n);
    int r = sd_bus_message_open_container(reply, 'a', "(sxxxu)");
    for (size_t i = 0; r >= 0 && i < n; i++) {
        r = sd_bus_message_append(reply, "(sxxxu)", people[i].name, people[i].enrolled_s,
                                  people[i].valid_from_s, people[i].valid_until_s,
                                  people[i].templates);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

int iso__bus_list_people(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return iso__bus_reply_list(call, context, append_people, out);
}

int iso__bus_delete_person(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const char *person;
    int r = sd_bus_message_read(call, "s", &person);
    if (r < 0) {
        return r;
    }
    r = iso_appliance_remove(bus->appliance, person, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

/* ---- a name in use ---- */

int iso__bus_reply_enrolment(sd_bus_message *call, const struct iso_person *known)
{
    return known
               ? sd_bus_reply_method_return(call, "a{sv}", 5, ISO_CONTRACT_PERSON, "s", known->name,
                                            ISO_CONTRACT_ENROLLED, "x", known->enrolled_s,
                                            ISO_CONTRACT_TEMPLATES, "u", known->templates,
                                            ISO_CONTRACT_VALID_FROM, "x", known->valid_from_s,
                                            ISO_CONTRACT_VALID_UNTIL, "x", known->valid_until_s)
               : sd_bus_reply_method_return(call, "a{sv}", 0);
}

/* The methods of the actions of the claim, of the status, of lock-out and lockdown, and of the
 * log; and the error of the contract for an errno. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"

enum { LOG_RECORDS_MAX = 1000 };

/* ---- errors ---- */

int iso__bus_refuse(sd_bus_error *out, int error, const struct iso_fault *fault)
{
    static const struct {
        int error;
        const char *name;
    } names[] = {
        {-EACCES, ISO_CONTRACT_ERROR_CLAIM_DEVICE},
        {-EBUSY, ISO_CONTRACT_ERROR_ACTION},
        {-ENODEV, ISO_CONTRACT_ERROR_DEVICE_FAULT},
        {-ENOENT, ISO_CONTRACT_ERROR_NO_SUCH_PERSON},
        {-EDQUOT, ISO_CONTRACT_ERROR_GALLERY_FULL},
        {-EEXIST, ISO_CONTRACT_ERROR_NAME_IN_USE},
        {-ECANCELED, ISO_CONTRACT_ERROR_CONFLICT},
        {-ENODATA, ISO_CONTRACT_ERROR_NO_ACTION},
        {-EINVAL, ISO_CONTRACT_ERROR_INVALID_ARGUMENT},
        {-EKEYREJECTED, ISO_CONTRACT_ERROR_REJECTED},
        {-EBADMSG, ISO_CONTRACT_ERROR_REJECTED},
        {-EPERM, ISO_CONTRACT_ERROR_LOCKED_OUT},
        {-EOPNOTSUPP, ISO_CONTRACT_ERROR_NO_LOGINS},
        {-EIO, ISO_CONTRACT_ERROR_STORAGE},
        {-ENOSPC, ISO_CONTRACT_ERROR_STORAGE},
        {-EROFS, ISO_CONTRACT_ERROR_STORAGE},
    };
    /* The text of a fault may be cut within a character, but the bus accepts valid UTF-8 only. */
    char text[sizeof fault->text];
    iso__bus_clean_text(text, sizeof text, fault->text[0] ? fault->text : strerror(-error));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (names[i].error == error) {
            return sd_bus_error_set(out, names[i].name, text);
        }
    }
    return sd_bus_error_set(out, ISO_CONTRACT_ERROR_INTERNAL, text);
}

static int invalid_name(sd_bus_error *out, const char *flaw)
{
    return sd_bus_error_set(out, ISO_CONTRACT_ERROR_INVALID_NAME, flaw);
}

/* ---- actions ---- */

/* What a call of EnrollStart asks for. */
struct wish {
    struct iso_enroll_request request;
    bool consent; /* the person has consented, which is put on record */
};

static int read_flag(sd_bus_message *call, bool *flag)
{
    int value = 0;
    const int r = sd_bus_message_read(call, "v", "b", &value);
    *flag = value != 0;
    return r < 0 ? r : 1;
}

/* Reads one {sv}, whose container has been entered already. */
static int read_option(sd_bus_message *call, struct wish *wish, sd_bus_error *out)
{
    const char *name;
    int r = sd_bus_message_read_basic(call, 's', &name);
    if (r < 0) {
        return r;
    }
    if (strcmp(name, ISO_CONTRACT_ALLOW_DUPLICATE) == 0) {
        r = read_flag(call, &wish->request.allow_duplicate);
    } else if (strcmp(name, ISO_CONTRACT_POSES) == 0) {
        r = read_flag(call, &wish->request.poses);
    } else if (strcmp(name, ISO_CONTRACT_CONSENT) == 0) {
        r = read_flag(call, &wish->consent);
    } else {
        r = iso__bus_read_validity_option(call, name, &wish->request.validity);
    }
    return r > 0 ? r : iso__bus_refuse_option(out, r, name);
}

static int read_options(sd_bus_message *call, struct wish *wish, sd_bus_error *out)
{
    int r = sd_bus_message_enter_container(call, 'a', "{sv}");
    while (r >= 0 && (r = sd_bus_message_enter_container(call, 'e', "sv")) > 0) {
        r = read_option(call, wish, out);
        if (r >= 0) {
            r = sd_bus_message_exit_container(call);
        }
    }
    return r;
}

int iso__bus_enroll_start(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    struct wish wish = {.consent = false};
    const char *person = NULL;
    struct iso_fault fault = {.text = ""};
    int r = iso__bus_require_claim(bus, call, out);
    if (r >= 0) {
        r = sd_bus_message_read(call, "s", &person);
    }
    if (r >= 0) {
        r = read_options(call, &wish, out);
    }
    if (r < 0) {
        return r;
    }
    const char *flaw = iso_person_name_flaw(person);
    if (flaw) {
        return invalid_name(out, flaw);
    }
    wish.request.person = person;
    r = wish.consent ? iso__bus_record_consent(bus, call, person, &fault) : 0;
    if (r >= 0) {
        r = iso_appliance_enroll(bus->appliance, &wish.request, &fault);
    }
    return r < 0 ? iso__bus_refuse(out, r, &fault)
                 : iso__bus_reply_enrolment(call, iso_gallery_find(bus->borrowed->gallery, person));
}

int iso__bus_verify_start(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const char *person;
    int r = iso__bus_require_claim(bus, call, out);
    if (r >= 0) {
        r = sd_bus_message_read(call, "s", &person);
    }
    if (r < 0) {
        return r;
    }
    r = iso_appliance_verify(bus->appliance, person, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

int iso__bus_identify_start(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    int r = iso__bus_require_claim(bus, call, out);
    if (r < 0) {
        return r;
    }
    r = iso_appliance_identify(bus->appliance, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

static int stop_action(struct iso_bus *bus, sd_bus_message *call, enum iso_appliance_mode mode,
                       sd_bus_error *out)
{
    const int r = iso__bus_require_claim(bus, call, out);
    if (r < 0) {
        return r;
    }
    if (iso_appliance_stop_action(bus->appliance, mode) < 0) {
        return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_NO_ACTION, "there is no %s to stop",
                                 iso_appliance_mode_name(mode));
    }
    return sd_bus_reply_method_return(call, NULL);
}

int iso__bus_enroll_stop(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return stop_action(context, call, ISO_APPLIANCE_ENROLL, out);
}

int iso__bus_verify_stop(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return stop_action(context, call, ISO_APPLIANCE_VERIFY, out);
}

int iso__bus_identify_stop(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return stop_action(context, call, ISO_APPLIANCE_IDENTIFY, out);
}

/* ---- status ---- */

int iso__bus_send_reply(sd_bus_message *reply, int r)
{
    if (r >= 0) {
        r = sd_bus_send(NULL, reply, NULL);
    }
    sd_bus_message_unref(reply);
    return r;
}

int iso__bus_get_status(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    sd_bus_message *reply = NULL;
    const int r = sd_bus_message_new_method_return(call, &reply);
    (void)out;
    return iso__bus_send_reply(reply, r < 0 ? r : iso__bus_append_status(reply, bus));
}

/* ---- refusal ---- */

int iso__bus_clear_lockout(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const int r = iso_appliance_clear_lockout(bus->appliance, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

int iso__bus_set_lockdown(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    int on = 0;
    int r = sd_bus_message_read(call, "b", &on);
    if (r < 0) {
        return r;
    }
    r = iso_appliance_lockdown(bus->appliance, on != 0, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

/* ---- log ---- */

static int append_line(void *context, const char *line)
{
    const int r = sd_bus_message_append_basic(context, 's', line);
    return r < 0 ? r : 0;
}

int iso__bus_read_log(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct iso_audit_writer *log = iso_appliance_log(bus->appliance);
    sd_bus_message *reply = NULL;
    uint64_t from;
    uint32_t max;
    int r = sd_bus_message_read(call, "tu", &from, &max);
    (void)out;
    if (r < 0) {
        return r;
    }
    max = max < LOG_RECORDS_MAX ? max : LOG_RECORDS_MAX;
    r = sd_bus_message_new_method_return(call, &reply);
    if (r >= 0) {
        r = sd_bus_message_open_container(reply, 'a', "s");
    }
    if (r >= 0) {
        r = iso_audit_read(iso_audit_writer_hold(log), from, max, append_line, reply);
        iso_audit_writer_release(log);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(reply);
    }
    return iso__bus_send_reply(reply, r);
}

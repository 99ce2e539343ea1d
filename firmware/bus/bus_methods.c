/* The methods of the contract. */
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
        {-ENODATA, ISO_CONTRACT_ERROR_NO_ACTION},
        {-EINVAL, ISO_CONTRACT_ERROR_INVALID_ARGUMENT},
        {-EKEYREJECTED, ISO_CONTRACT_ERROR_REJECTED},
        {-EBADMSG, ISO_CONTRACT_ERROR_REJECTED},
        {-EPERM, ISO_CONTRACT_ERROR_LOCKED_OUT},
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

/* ---- claim ---- */

void iso__bus_forget_claimant(struct iso_bus *bus)
{
    bus->track = sd_bus_track_unref(bus->track);
    bus->claimant[0] = '\0';
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
    return 0;
}

static int on_claim(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    const char *sender = sd_bus_message_get_sender(call);
    if (bus->claimant[0]) {
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_ALREADY_IN_USE,
                                strcmp(bus->claimant, sender) == 0
                                    ? "this client has the camera already"
                                    : "another client has the camera");
    }
    int r = sd_bus_track_new(bus->bus, &bus->track, on_claimant_gone, bus);
    if (r >= 0) {
        r = sd_bus_track_add_sender(bus->track, call);
    }
    if (r >= 0) {
        r = iso_appliance_claim(bus->appliance);
    }
    if (r < 0) {
        bus->track = sd_bus_track_unref(bus->track);
        return r;
    }
    (void)snprintf(bus->claimant, sizeof bus->claimant, "%s", sender);
    return sd_bus_reply_method_return(call, NULL);
}

static int on_release(sd_bus_message *call, void *context, sd_bus_error *out)
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

static int on_enroll_start(sd_bus_message *call, void *context, sd_bus_error *out)
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

static int on_verify_start(sd_bus_message *call, void *context, sd_bus_error *out)
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

static int on_identify_start(sd_bus_message *call, void *context, sd_bus_error *out)
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

static int on_enroll_stop(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return stop_action(context, call, ISO_APPLIANCE_ENROLL, out);
}

static int on_verify_stop(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return stop_action(context, call, ISO_APPLIANCE_VERIFY, out);
}

static int on_identify_stop(sd_bus_message *call, void *context, sd_bus_error *out)
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

static int on_get_status(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    sd_bus_message *reply = NULL;
    const int r = sd_bus_message_new_method_return(call, &reply);
    (void)out;
    return iso__bus_send_reply(reply, r < 0 ? r : iso__bus_append_status(reply, bus));
}

/* ---- refusal ---- */

static int on_clear_lockout(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const int r = iso_appliance_clear_lockout(bus->appliance, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

static int on_set_lockdown(sd_bus_message *call, void *context, sd_bus_error *out)
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

static int on_read_log(sd_bus_message *call, void *context, sd_bus_error *out)
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

/* ---- the table ---- */

/* The names of the arguments, each followed by a NUL. The list ends with an empty name. */
#define NOTHING ""
#define METHOD(name, in, in_names, out, out_names, handler)               \
    SD_BUS_METHOD_WITH_NAMES(name, in, in_names, out, out_names, handler, \
                             SD_BUS_VTABLE_UNPRIVILEGED)
#define SIGNAL(name, signature, names) SD_BUS_SIGNAL_WITH_NAMES(name, signature, names, 0)

const sd_bus_vtable iso__bus_vtable[] = {
    SD_BUS_VTABLE_START(0),
    METHOD(ISO_CONTRACT_CLAIM, "", NOTHING, "", NOTHING, on_claim),
    METHOD(ISO_CONTRACT_RELEASE, "", NOTHING, "", NOTHING, on_release),
    METHOD(ISO_CONTRACT_ENROLL_START, "sa{sv}", "person\0options\0", "a{sv}", "known\0",
           on_enroll_start),
    METHOD(ISO_CONTRACT_ENROLL_STOP, "", NOTHING, "", NOTHING, on_enroll_stop),
    METHOD(ISO_CONTRACT_VERIFY_START, "s", "person\0", "", NOTHING, on_verify_start),
    METHOD(ISO_CONTRACT_VERIFY_STOP, "", NOTHING, "", NOTHING, on_verify_stop),
    METHOD(ISO_CONTRACT_IDENTIFY_START, "", NOTHING, "", NOTHING, on_identify_start),
    METHOD(ISO_CONTRACT_IDENTIFY_STOP, "", NOTHING, "", NOTHING, on_identify_stop),
    METHOD(ISO_CONTRACT_LIST_PEOPLE, "", NOTHING, "a(sxxxu)", "people\0", iso__bus_list_people),
    METHOD(ISO_CONTRACT_DELETE_PERSON, "s", "person\0", "", NOTHING, iso__bus_delete_person),
    METHOD(ISO_CONTRACT_SET_VALIDITY, "sa{sv}", "person\0options\0", "sxx",
           "person\0valid_from\0valid_until\0", iso__bus_set_validity),
    METHOD(ISO_CONTRACT_RENAME_PERSON, "ss", "person\0name\0", "s", "remark\0", iso__bus_rename),
    METHOD(ISO_CONTRACT_GET_STATUS, "", NOTHING, "a{sv}", "status\0", on_get_status),
    METHOD(ISO_CONTRACT_GET_SETTINGS, "", NOTHING, "a(ssssssbs)", "settings\0",
           iso__bus_get_settings),
    METHOD(ISO_CONTRACT_SET_SETTING, "sss", "section\0key\0value\0", "s", "value\0",
           iso__bus_set_setting),
    METHOD(ISO_CONTRACT_RESET_SETTING, "ss", "section\0key\0", "s", "value\0",
           iso__bus_reset_setting),
    METHOD(ISO_CONTRACT_GET_SITE, "", NOTHING, "a{sv}", "site\0", iso__bus_get_site),
    METHOD(ISO_CONTRACT_LIST_LOOK_ALIKES, "", NOTHING, "a(ssd)", "pairs\0",
           iso__bus_list_look_alikes),
    METHOD(ISO_CONTRACT_LIST_OTHER, "", NOTHING, "as", "people\0", iso__bus_list_other),
    METHOD(ISO_CONTRACT_RESET_SITE, "", NOTHING, "u", "templates\0", iso__bus_reset_site),
    METHOD(ISO_CONTRACT_ROLL_BACK_SITE, "", NOTHING, "u", "templates\0", iso__bus_roll_back_site),
    METHOD(ISO_CONTRACT_READ_LOG, "tu", "from\0max\0", "as", "records\0", on_read_log),
    METHOD(ISO_CONTRACT_VERIFY_LOG, "ts", "sequence\0head\0", "bttsts",
           "sound\0first\0last\0head\0flaw_at\0flaw\0", iso__bus_verify_log),
    METHOD(ISO_CONTRACT_EXPORT_PEOPLE, "hasa{sv}", "file\0people\0options\0", "u", "people\0",
           iso__bus_export),
    METHOD(ISO_CONTRACT_IMPORT_PEOPLE, "ha{sv}", "file\0options\0", "uu", "added\0known\0",
           iso__bus_import),
    METHOD(ISO_CONTRACT_ROTATE_KEYS, "", NOTHING, "s", "remark\0", iso__bus_rotate_keys),
    METHOD(ISO_CONTRACT_GET_ADDRESS, "", NOTHING, "s", "address\0", iso__bus_get_address),
    METHOD(ISO_CONTRACT_CLEAR_LOCKOUT, "", NOTHING, "", NOTHING, on_clear_lockout),
    METHOD(ISO_CONTRACT_SET_LOCKDOWN, "b", "on\0", "", NOTHING, on_set_lockdown),
    METHOD(ISO_CONTRACT_TEST_DOOR, "", NOTHING, "", NOTHING, iso__bus_test_door),
    METHOD(ISO_CONTRACT_RECORD_ACT, "sss", "account\0act\0person\0", "", NOTHING,
           iso__bus_record_act),
    METHOD(ISO_CONTRACT_AIM_START, "", NOTHING, "", NOTHING, iso__bus_aim_start),
    METHOD(ISO_CONTRACT_AIM_STOP, "", NOTHING, "", NOTHING, iso__bus_aim_stop),
    METHOD(ISO_CONTRACT_WATCH, "s", "what\0", "h", "stream\0", iso__bus_watch),
    METHOD(ISO_CONTRACT_WATCH_RELIEF, "", NOTHING, "h", "stream\0", iso__bus_watch_relief),
    METHOD(ISO_CONTRACT_PICTURE, "", NOTHING, "h", "file\0", iso__bus_picture),
    SIGNAL(ISO_CONTRACT_ENROLL_STATUS, "sbuuds", "result\0done\0stage\0stages\0quality\0person\0"),
    SIGNAL(ISO_CONTRACT_ENROLL_STEP, "ssuud", "pose\0state\0step\0steps\0turn_deg\0"),
    SIGNAL(ISO_CONTRACT_VERIFY_STATUS, "sbsdd", "result\0done\0person\0score\0threshold\0"),
    SIGNAL(ISO_CONTRACT_IDENTIFY_STATUS, "sbsdd", "result\0done\0person\0score\0threshold\0"),
    SIGNAL(ISO_CONTRACT_VISIT, "ssdduxsss",
           "verdict\0person\0score\0threshold\0frames\0latency_us\0reason\0door\0"
           "door_fault\0"),
    SIGNAL(ISO_CONTRACT_HINT, "s", "word\0"),
    SIGNAL(ISO_CONTRACT_VIEW, "a{sv}", "view\0"),
    SIGNAL(ISO_CONTRACT_DOOR_CHANGED, "ss", "state\0cause\0"),
    SIGNAL(ISO_CONTRACT_PROGRESS, "tt", "done\0total\0"),
    SD_BUS_VTABLE_END,
};

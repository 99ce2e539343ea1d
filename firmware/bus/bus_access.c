/* The methods of the policy and of credentials. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"
#include "firmware/policy/credential/credential_json.h"

enum { WHO_SIZE = 48 };

/* ---- the policy ---- */

int iso__bus_get_policy(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    size_t size = 0;
    struct iso_fault fault = {.text = ""};
    int r = iso_gallery_state(bus->borrowed->gallery, &fault);
    if (r < 0) {
        return iso__bus_refuse(out, r, &fault);
    }
    const struct iso_site_access *access = iso_appliance_access(bus->appliance);
    char *text = iso_site_access_text(bus->borrowed->gallery, &size);
    r = text ? sd_bus_reply_method_return(call, "st", text, iso_site_access_revision(access))
             : -ENOMEM;
    free(text);
    return r;
}

static int append_sentence(void *context, const char *sentence)
{
    char clean[300];
    iso__bus_clean_text(clean, sizeof clean, sentence);
    const int r = sd_bus_message_append_basic(context, 's', clean);
    return r < 0 ? r : 0;
}

static int append_findings(sd_bus_message *reply, const struct iso_bus *bus)
{
    bool known = false;
    const struct iso_site_access *access = iso_appliance_access(bus->appliance);
    int r = sd_bus_message_open_container(reply, 'a', "s");
    if (r >= 0 && *iso_site_access_fault(access)->text) {
        r = append_sentence(reply, iso_site_access_fault(access)->text);
    }
    if (r >= 0) {
        r = iso_site_access_check(access, bus->borrowed->gallery,
                                  iso_appliance_date_s(bus->appliance, &known), append_sentence,
                                  reply);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

int iso__bus_set_policy(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    char who[WHO_SIZE];
    const char *document;
    uint64_t revision;
    sd_bus_message *reply = NULL;
    struct iso_fault fault = {.text = ""};
    int r = sd_bus_message_read(call, "st", &document, &revision);
    if (r < 0) {
        return r;
    }
    iso__bus_describe_caller(call, who, sizeof who);
    r = iso_appliance_set_policy(bus->appliance, document, revision, who, &revision, &fault);
    if (r < 0) {
        return iso__bus_refuse(out, r, &fault);
    }
    r = sd_bus_message_new_method_return(call, &reply);
    r = r < 0 ? r : sd_bus_message_append(reply, "t", revision);
    return iso__bus_send_reply(reply, r < 0 ? r : append_findings(reply, bus));
}

int iso__bus_check_policy(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return iso__bus_reply_list(call, context, append_findings, out);
}

/* ---- what the door would decide ---- */

static const struct {
    const char *word;
    uint8_t method;
} methods[] = {
    {ISO_CONTRACT_WANTED_FACE, ISO_RECOGNITION_FACE},
    {ISO_CONTRACT_WANTED_CARD, ISO_RECOGNITION_CARD},
    {ISO_CONTRACT_WANTED_PIN, ISO_RECOGNITION_PIN},
};

enum { METHODS = sizeof methods / sizeof *methods };

/* Reads the list of what was shown. A PIN that was shown is the right one. */
static int read_shown(sd_bus_message *call, iso_pin pin, struct iso_shown *shown, sd_bus_error *out)
{
    const char *word;
    int r = sd_bus_message_enter_container(call, 'a', "s");
    while (r >= 0 && (r = sd_bus_message_read_basic(call, 's', &word)) > 0) {
        size_t i = 0;
        while (i < METHODS && strcmp(methods[i].word, word) != 0) {
            i++;
        }
        if (i == METHODS) {
            return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                     "'%s' cannot be shown; face, card and pin can", word);
        }
        if (methods[i].method == ISO_RECOGNITION_PIN) {
            shown->pin = pin;
        } else {
            shown->matched |= methods[i].method;
        }
    }
    return r < 0 ? r : sd_bus_message_exit_container(call);
}

static int append_wanted(sd_bus_message *reply, uint8_t wanted)
{
    int r = sd_bus_message_open_container(reply, 'e', "sv");
    r = r < 0 ? r : sd_bus_message_append(reply, "s", ISO_CONTRACT_ACCESS_WANTED);
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'v', "as");
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'a', "s");
    for (size_t i = 0; r >= 0 && i < METHODS; i++) {
        if (wanted & methods[i].method) {
            r = sd_bus_message_append(reply, "s", methods[i].word);
        }
    }
    for (int i = 0; r >= 0 && i < 3; i++) {
        r = sd_bus_message_close_container(reply);
    }
    return r;
}

static int append_entry(sd_bus_message *reply, const char *key, const char *value)
{
    return sd_bus_message_append(reply, "{sv}", key, "s", value);
}

static int append_answer(sd_bus_message *reply, const struct iso_site_access *access,
                         const char *access_point, const struct iso_access *answer)
{
    static const char *const outcomes[] = {
        [ISO_ACCESS_DENY] = ISO_CONTRACT_ACCESS_DENY,
        [ISO_ACCESS_ALLOW] = ISO_CONTRACT_ACCESS_ALLOW,
        [ISO_ACCESS_WANT] = ISO_CONTRACT_ACCESS_WANT,
    };
    const struct iso_policy_document *document = iso_site_access_document(access);
    const struct iso_policy *policy = document ? iso_policy_document_policy(document) : NULL;
    const char *here = policy ? policy->access_points[iso_site_access_point(access)].token : "";
    int r = sd_bus_message_open_container(reply, 'a', "{sv}");
    r = r < 0 ? r : append_entry(reply, ISO_CONTRACT_ACCESS_OUTCOME, outcomes[answer->outcome]);
    r = r < 0
            ? r
            : append_entry(
                  reply, ISO_CONTRACT_ACCESS_REASON,
                  answer->outcome == ISO_ACCESS_DENY ? iso_access_reason_name(answer->reason) : "");
    r = r < 0 ? r : append_wanted(reply, answer->wanted);
    r = r < 0 ? r
              : sd_bus_message_append(reply, "{sv}", ISO_CONTRACT_ACCESS_COMPANION, "b",
                                      (int)answer->companion_wanted);
    r = r < 0
            ? r
            : append_entry(reply, ISO_CONTRACT_ACCESS_LEVEL,
                           policy && answer->has_level ? policy->levels[answer->level].token : "");
    r = r < 0 ? r
              : append_entry(reply, ISO_CONTRACT_ACCESS_POINT, *access_point ? access_point : here);
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

/* Returns an error of the contract if the policy has no such access point. */
static int check_point(const struct iso_site_access *access, const char *access_point,
                       sd_bus_error *out)
{
    const struct iso_policy_document *document = iso_site_access_document(access);
    return !*access_point || (document && iso_policy_document_access_point(
                                              document, access_point) != ISO_INDEX_NONE)
               ? 0
               : sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                   "the policy has no access point '%s'", access_point);
}

int iso__bus_test_access(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    const struct iso_gallery *gallery = bus->borrowed->gallery;
    struct iso_site_access *access = iso_appliance_access(bus->appliance);
    const char *name, *access_point;
    sd_bus_message *reply = NULL;
    struct iso_fault fault = {.text = ""};
    struct iso_site_request request = {.time_known = true};
    int r = sd_bus_message_read(call, "ssx", &name, &access_point, &request.time_s);
    if (r < 0) {
        return r;
    }
    const struct iso_person *person = iso_gallery_find(gallery, name);
    if (!person) {
        return iso__bus_refuse(out, iso_fault_set(&fault, -ENOENT, "%s: no such person", name),
                               &fault);
    }
    request.person = person->id;
    request.access_point = *access_point ? access_point : NULL;
    struct iso_credential_record record = iso_site_access_credential(gallery, person->id);
    r = check_point(access, access_point, out);
    r = r < 0 ? r : read_shown(call, record.pin, &request.shown, out);
    iso_credential_record_wipe(&record);
    if (r < 0) {
        return r;
    }
    const struct iso_access answer = iso_site_access_decide(access, gallery, &request);
    r = sd_bus_message_new_method_return(call, &reply);
    return iso__bus_send_reply(reply,
                               r < 0 ? r : append_answer(reply, access, access_point, &answer));
}

/* ---- credentials ---- */

/* The text of a person's credential, which the caller frees; NULL without memory. */
static char *text_of(const struct iso_gallery *gallery, int64_t person)
{
    struct iso_credential_record record = iso_site_access_credential(gallery, person);
    char *text = iso_credential_text(&record);
    iso_credential_record_wipe(&record);
    return text;
}

static int reply_credential(sd_bus_message *call, const struct iso_bus *bus, const char *name,
                            sd_bus_error *out)
{
    const struct iso_person *person = iso_gallery_find(bus->borrowed->gallery, name);
    struct iso_fault fault = {.text = ""};
    int r = iso_gallery_state(bus->borrowed->gallery, &fault);
    if (r >= 0 && !person) {
        r = iso_fault_set(&fault, -ENOENT, "%s: no such person", name);
    }
    if (r < 0) {
        return iso__bus_refuse(out, r, &fault);
    }
    char *text = text_of(bus->borrowed->gallery, person->id);
    r = text ? sd_bus_reply_method_return(call, "s", text) : -ENOMEM;
    free(text);
    return r;
}

int iso__bus_get_credential(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const char *name;
    const int r = sd_bus_message_read(call, "s", &name);
    return r < 0 ? r : reply_credential(call, context, name, out);
}

int iso__bus_set_credential(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    char who[WHO_SIZE];
    const char *name, *patch;
    struct iso_fault fault = {.text = ""};
    /* It may contain a PIN. */
    int r = sd_bus_message_sensitive(call);
    r = r < 0 ? r : sd_bus_message_read(call, "ss", &name, &patch);
    if (r < 0) {
        return r;
    }
    iso__bus_describe_caller(call, who, sizeof who);
    r = iso_appliance_set_credential(bus->appliance, name, patch, who, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : reply_credential(call, bus, name, out);
}

static int append_credentials(sd_bus_message *reply, const struct iso_bus *bus)
{
    size_t n = 0, size = 0;
    const struct iso_gallery *gallery = bus->borrowed->gallery;
    const struct iso_person *people = iso_gallery_people(gallery, &n);
    int r = sd_bus_message_open_container(reply, 'a', "(ss)");
    for (size_t i = 0; r >= 0 && i < n; i++) {
        if (!iso_gallery_access(gallery, people[i].id, &size)) {
            continue;
        }
        char *text = text_of(gallery, people[i].id);
        r = text ? sd_bus_message_append(reply, "(ss)", people[i].name, text) : -ENOMEM;
        free(text);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

int iso__bus_list_credentials(sd_bus_message *call, void *context, sd_bus_error *out)
{
    return iso__bus_reply_list(call, context, append_credentials, out);
}

/* The method with which a client puts on record for whom of its own users it acts, and the record
 * of a consent, for clients whose users are those of the bus. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/person_name.h"

/* The user who makes a call, as the bus knows it. A negative errno if it is not known. */
int iso__bus_user_of(sd_bus_message *call, uid_t *user)
{
    sd_bus_creds *creds = NULL;
    int r = sd_bus_query_sender_creds(call, SD_BUS_CREDS_EUID, &creds);
    if (r >= 0) {
        r = sd_bus_creds_get_euid(creds, user);
    }
    sd_bus_creds_unref(creds);
    return r;
}

void iso__bus_describe_caller(sd_bus_message *call, char *who, size_t size)
{
    uid_t user = 0;
    if (iso__bus_user_of(call, &user) >= 0) {
        (void)snprintf(who, size, "asked by user %u", (unsigned)user);
    } else {
        (void)snprintf(who, size, "asked by a user who is not known");
    }
}

bool iso__bus_is_word(const char *text, size_t most)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyz0123456789.-_";
    const size_t n = strlen(text);
    return n > 0 && n <= most && strspn(text, allowed) == n;
}

static int check(const char *account, const char *act, const char *person, sd_bus_error *out)
{
    const char *flaw = *person ? iso_person_name_flaw(person) : NULL;
    if (!iso__bus_is_word(account, ISO_CONTRACT_ACCOUNT_BYTES) ||
        !iso__bus_is_word(act, ISO_CONTRACT_ACT_BYTES)) {
        return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                 "an account and an act are words of small letters, digits, '.', "
                                 "'-' and '_', at most %d and %d bytes long",
                                 ISO_CONTRACT_ACCOUNT_BYTES, ISO_CONTRACT_ACT_BYTES);
    }
    return flaw ? sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_NAME, "%s", flaw) : 0;
}

int iso__bus_record_act(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    const char *account = NULL, *act = NULL, *person = NULL;
    struct iso_fault fault = {.text = ""};
    char note[ISO_CONTRACT_ACCOUNT_BYTES + ISO_CONTRACT_ACT_BYTES + 32];
    uid_t user = 0;
    int r = sd_bus_message_read(call, "sss", &account, &act, &person);
    if (r >= 0) {
        r = check(account, act, person, out);
    }
    if (r >= 0) {
        r = iso__bus_user_of(call, &user);
    }
    if (r < 0) {
        return r;
    }
    (void)snprintf(note, sizeof note, "%s, asked by %s of user %u", act, account, (unsigned)user);
    r = iso_appliance_record_act(bus->appliance, person, note, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

int iso__bus_record_consent(struct iso_bus *bus, sd_bus_message *call, const char *person,
                            struct iso_fault *fault)
{
    char note[64];
    uid_t user = 0;
    const int r = iso__bus_user_of(call, &user);
    if (r < 0) {
        return r;
    }
    (void)snprintf(note, sizeof note, "consent, asked by user %u", (unsigned)user);
    return iso_appliance_record_act(bus->appliance, person, note, fault);
}

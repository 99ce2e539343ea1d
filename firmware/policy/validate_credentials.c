#include <errno.h>
#include <string.h>

#include "core/base/fault.h"
#include "firmware/policy/validate_parts.h"

/* Whether the number is a 1 before 4 to 9 digits. */
static bool is_pin(iso_pin pin)
{
    uint32_t first = 10000;
    for (int digits = ISO_PIN_DIGITS_MIN; digits <= ISO_PIN_DIGITS_MAX; digits++) {
        if (pin >= first && pin < 2 * first) {
            return true;
        }
        first *= 10;
    }
    return false;
}

static const char *pin_flaw(const struct iso_credential *credential)
{
    const bool has_pin = (credential->identifiers & ISO_RECOGNITION_PIN) != 0;
    if (has_pin != (credential->pin != 0)) {
        return has_pin ? "is said to have a PIN and has none"
                       : "has a PIN and is said to have none";
    }
    if (has_pin && !is_pin(credential->pin)) {
        return "has a PIN that is not of 4 to 9 digits";
    }
    if (credential->duress_pin == 0) {
        return NULL;
    }
    if (!is_pin(credential->duress_pin)) {
        return "has a duress PIN that is not of 4 to 9 digits";
    }
    return !has_pin                                    ? "has a duress PIN and no PIN"
           : credential->duress_pin == credential->pin ? "has its PIN as duress PIN"
                                                       : NULL;
}

static const char *flaw_of(const struct iso_credential *credential)
{
    if (!memchr(credential->disabled_reason, '\0', sizeof credential->disabled_reason)) {
        return "has a reason without an end";
    }
    if (credential->identifiers == 0) {
        return "has no identifiers";
    }
    if ((credential->identifiers & ~ISO_RECOGNITION_ALL) != 0) {
        return "has an identifier of a kind that does not exist";
    }
    if (credential->valid_from_s < 0 || credential->valid_to_s < 0) {
        return "has a validity before 1970";
    }
    if (credential->valid_to_s != 0 && credential->valid_to_s <= credential->valid_from_s) {
        return "has a validity that ends before it begins";
    }
    return pin_flaw(credential);
}

int iso__validate_credentials(const struct iso_policy *policy, struct iso_fault *fault)
{
    int error = 0;
    for (uint32_t i = 0; error == 0 && i < policy->n_credentials; i++) {
        const struct iso_credential *credential = &policy->credentials[i];
        const struct iso__record record = {"credential", credential->token, fault};
        error = iso__validate_token(record.kind, i, record.token, fault);
        const char *flaw = error == 0 ? flaw_of(credential) : NULL;
        if (flaw) {
            error = iso_fault_set(fault, -EINVAL, "%s \"%s\": %s", record.kind, record.token, flaw);
        }
        error = error != 0 ? error
                           : iso__validate_count(&record, "access profiles", credential->n_profiles,
                                                 ISO_CREDENTIAL_PROFILES_MAX);
        for (int p = 0; error == 0 && p < credential->n_profiles; p++) {
            error = iso__validate_index(&record, "access profile", credential->profiles[p],
                                        policy->n_access_profiles);
        }
    }
    return error;
}

#include "enroll/hub/store/hub_policy.h"

#include <string.h>

#include "firmware/policy/credential/credential_json.h"
#include "firmware/policy/document/policy_document.h"
#include "firmware/policy/zones/zone_file.h"

int hub__policy_check(const char *document, struct iso_fault *fault)
{
    char folder[] = ISO_ZONE_FOLDER;
    const struct iso_zone_source zones = {.read = iso_zone_file_read, .context = folder};
    struct iso_policy_document *read = NULL;
    if (!*document) {
        return 0;
    }
    const int error = iso_policy_document_read(document, strlen(document), &zones, &read, fault);
    if (!error) {
        iso_policy_document_free(read);
    }
    return error;
}

int hub__credential_check(const char *json, struct iso_fault *fault)
{
    struct iso_credential_record record = iso_credential_record_new();
    const int error = *json ? iso_credential_patch(json, &record, fault) : 0;
    iso_credential_record_wipe(&record);
    return error;
}

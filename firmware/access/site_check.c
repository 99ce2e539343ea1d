/* What in the policy can never let anybody in. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/access/site_access_state.h"
#include "firmware/policy/check.h"

/* Makes the credentials of all people. A finding names a person by the token of the credential, so
 * this is the name here, cut to a whole character. */
static void fill(const struct iso_policy_document *document, const struct iso_gallery *gallery,
                 const struct iso_person *people, struct iso_credential *credentials, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        struct iso_credential_record record = iso_site_access_credential(gallery, people[i].id);
        iso__site_credential(document, &people[i], &record, &credentials[i]);
        iso_credential_record_wipe(&record);
        char *token = credentials[i].token;
        size_t length = strnlen(people[i].name, ISO_TOKEN_SIZE - 1);
        while (length > 0 && ((unsigned char)people[i].name[length] & 0xc0) == 0x80) {
            length--;
        }
        (void)snprintf(token, ISO_TOKEN_SIZE, "%.*s", (int)length, people[i].name);
    }
}

static int tell(const struct iso_policy *policy, const struct iso_policy_finding *findings,
                size_t n, int (*each)(void *context, const char *sentence), void *context)
{
    char text[ISO_POLICY_FINDING_TEXT_SIZE];
    int result = 0;
    for (size_t i = 0; !result && i < n; i++) {
        result = each(context, iso_policy_finding_text(policy, &findings[i], text));
    }
    return result;
}

/* Finds out how many findings there are, and then gets all. */
static int check_all(const struct iso_policy *policy, int64_t now_s,
                     int (*each)(void *context, const char *sentence), void *context)
{
    const size_t n = iso_policy_check(policy, now_s, NULL, 0);
    struct iso_policy_finding *findings = calloc(n ? n : 1, sizeof *findings);
    if (!findings) {
        return -ENOMEM;
    }
    (void)iso_policy_check(policy, now_s, findings, n);
    const int result = tell(policy, findings, n, each, context);
    free(findings);
    return result;
}

int iso_site_access_check(const struct iso_site_access *access, const struct iso_gallery *gallery,
                          int64_t now_s, int (*each)(void *context, const char *sentence),
                          void *context)
{
    size_t n = 0;
    if (!access->document) {
        return 0;
    }
    const struct iso_person *people = iso_gallery_people(gallery, &n);
    struct iso_credential *credentials = calloc(n ? n : 1, sizeof *credentials);
    if (!credentials) {
        return -ENOMEM;
    }
    fill(access->document, gallery, people, credentials, n);
    struct iso_policy policy = *iso_policy_document_policy(access->document);
    policy.credentials = credentials;
    policy.n_credentials = (uint32_t)n;
    const int result = check_all(&policy, now_s, each, context);
    explicit_bzero(credentials, n * sizeof *credentials);
    free(credentials);
    return result;
}

/* The reader of policies. A document that it accepts is written, read again, and is the same. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault.h"
#include "firmware/policy/check.h"
#include "firmware/policy/document/policy_document.h"
#include "firmware/policy/zones/zone_file.h"
#include "tests/fuzz/fuzz.h"

/* Every name of a zone is one, with the clock of UTC. */
static int read_zone(void *context, const char *name, struct iso_zone *out, struct iso_fault *fault)
{
    (void)context;
    if (!iso_zone_name_is_right(name)) {
        return iso_fault_set(fault, -EINVAL, "not a zone");
    }
    memset(out, 0, sizeof *out);
    (void)strcpy(out->name, name); /* the reader promises that it fits */
    return 0;
}

static const struct iso_zone_source zones = {read_zone, NULL};

static int refuse_change(void *context, const char *kind, const char *token, const char *before,
                         const char *after)
{
    (void)context, (void)kind, (void)token, (void)before, (void)after;
    return 1;
}

static void use(const struct iso_policy_document *document)
{
    char *json = NULL, *same = NULL;
    struct iso_policy_document *again = NULL;
    struct iso_policy_finding findings[4];
    struct iso_fault fault = {0};
    (void)iso_policy_check(iso_policy_document_policy(document), 1795608000, findings, 4);
    fuzz_check(iso_policy_document_write(document, &json, &fault) == 0, "it can be written");
    fuzz_check(iso_policy_document_read(json, strlen(json), &zones, &again, &fault) == 0,
               "what was written can be read");
    fuzz_check(iso_policy_document_write(again, &same, &fault) == 0 && strcmp(json, same) == 0,
               "the same policy gives the same bytes");
    fuzz_check(iso_policy_document_compare(document, again, refuse_change, NULL) == 0,
               "it is the same policy");
    iso_policy_document_free(again);
    free(json);
    free(same);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *bytes = fuzz_copy(data, size);
    struct iso_policy_document *document = NULL;
    struct iso_fault fault = {0};
    if (iso_policy_document_read((const char *)bytes, size, &zones, &document, &fault) == 0) {
        use(document);
    } else {
        fuzz_check(fault.text[0] != '\0' && !strpbrk(fault.text, "\n\r\033"), "one line");
    }
    iso_policy_document_free(document);
    free(bytes);
    return 0;
}

/* What the web server reads of cards and the policy: the list of what was shown, the body of a
 * change of the policy, and a credential of the daemon. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/access/access.h"
#include "tests/fuzz/fuzz.h"

static void try_shown(const char *text)
{
    bool shown[WEB_ACCESS_METHODS] = {true, false, true};

    if (web__access_shown_read(text, shown)) {
        size_t n = 0, bytes = 0;
        for (int i = 0; i < WEB_ACCESS_METHODS; i++) {
            n += shown[i];
            bytes += shown[i] ? strlen(web__access_methods[i]) : 0;
        }
        fuzz_check(strlen(text) == bytes + (n > 0 ? n - 1 : 0), "nothing else is in the list");
    } else {
        fuzz_check(shown[0] && !shown[1] && shown[2], "the output is unchanged after a refusal");
    }
}

static void try_change(const json_t *body)
{
    struct web_access_change change = {.revision = 77};
    const char *flaw = web__access_change_read(body, &change);

    if (flaw) {
        fuzz_check(change.revision == 77 && !change.document,
                   "the output is unchanged after a refusal");
        return;
    }
    json_t *again = *change.document ? json_loads(change.document, 0, NULL) : json_null();
    fuzz_check(json_equal(again, json_object_get(body, "document")),
               "the daemon gets the document of the request");
    json_decref(again);
    free(change.document);
}

static void try_members(const char *text)
{
    char *members = web__access_members(text), *object = NULL;

    if (members && asprintf(&object, "{\"name\":\"\"%s}", members) >= 0) {
        json_t *root = json_loads(object, JSON_REJECT_DUPLICATES, NULL);
        fuzz_check(json_object_size(root) == 3, "the members are two");
        fuzz_check(json_is_boolean(json_object_get(root, "enabled")), "a flag is a flag");
        json_decref(root);
        free(object);
    }
    free(members);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = (char *)fuzz_copy(data, size);
    json_t *body = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);

    try_shown(text);
    try_members(text);
    if (json_is_object(body)) {
        try_change(body);
    }
    json_decref(body);
    free(text);
    return 0;
}

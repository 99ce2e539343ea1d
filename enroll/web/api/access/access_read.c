/* Reads what requests and the daemon say about cards and the policy. Pure. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/access/access.h"
#include "firmware/contract/contract.h"

const char *const web__access_methods[WEB_ACCESS_METHODS] = {
    ISO_CONTRACT_WANTED_FACE, ISO_CONTRACT_WANTED_CARD, ISO_CONTRACT_WANTED_PIN};

/* The index of a method, or WEB_ACCESS_METHODS. */
static size_t method_of(const char *word, size_t length)
{
    size_t i = 0;
    while (i < WEB_ACCESS_METHODS && (strlen(web__access_methods[i]) != length ||
                                      memcmp(web__access_methods[i], word, length) != 0)) {
        i++;
    }
    return i;
}

bool web__access_shown_read(const char *text, bool shown[WEB_ACCESS_METHODS])
{
    bool found[WEB_ACCESS_METHODS] = {false};
    for (const char *word = text; *text && word;) {
        const size_t length = strcspn(word, ","), method = method_of(word, length);
        if (method == WEB_ACCESS_METHODS || found[method]) {
            return false;
        }
        found[method] = true;
        word = word[length] ? word + length + 1 : NULL;
    }
    memcpy(shown, found, sizeof found);
    return true;
}

const char *web__access_change_read(const json_t *body, struct web_access_change *out)
{
    const json_t *revision = json_object_get(body, "revision");
    const json_t *document = json_object_get(body, "document");
    if (!json_is_integer(revision) || json_integer_value(revision) < 0) {
        return "The member 'revision' is a whole number from 0 on.";
    }
    if (!json_is_object(document) && !json_is_null(document)) {
        return "The member 'document' is an object, or null for no policy.";
    }
    char *text = json_is_null(document) ? strdup("") : json_dumps(document, JSON_COMPACT);
    if (!text) {
        return "";
    }
    *out = (struct web_access_change){(uint64_t)json_integer_value(revision), text};
    return NULL;
}

char *web__access_members(const char *credential)
{
    char *members = NULL;
    json_t *root = json_loads(credential, JSON_REJECT_DUPLICATES, NULL);
    const json_t *cards = json_object_get(root, "cards");
    const json_t *enabled = json_object_get(root, "enabled");
    if (json_is_array(cards) && json_is_boolean(enabled)) {
        char *list = json_dumps(cards, JSON_COMPACT);
        if (list && asprintf(&members, ",\"cards\":%s,\"enabled\":%s", list,
                             json_is_true(enabled) ? "true" : "false") < 0) {
            members = NULL;
        }
        free(list);
    }
    json_decref(root);
    return members;
}

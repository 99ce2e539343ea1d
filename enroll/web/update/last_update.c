#include "enroll/web/update/last_update.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

#include "drivers/file/file.h"

enum { MOST_BYTES = 8192 };

static json_t *read_file(const char *folder)
{
    char path[PATH_MAX], *bytes = NULL;
    size_t size;

    (void)snprintf(path, sizeof path, "%s/result.json", folder);
    if (iso_file_read(path, MOST_BYTES, &bytes, &size, NULL)) {
        return NULL;
    }
    json_t *json = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, NULL);
    free(bytes);
    return json;
}

json_t *web_last_update(const char *folder)
{
    const char *from, *slot = NULL, *version = NULL, *code = NULL, *message = NULL;
    json_t *json = read_file(folder), *last = NULL;
    json_int_t at_s;

    if (json_unpack(json, "{s:s, s:I, s:{s?s, s?s, s?{s:s, s:s}}}", "from", &from, "at_s", &at_s,
                    "result", "slot", &slot, "version", &version, "error", "code", &code, "message",
                    &message) == 0 &&
        (slot || code)) {
        last = json_pack("{s:s, s:I, s:s?, s:s?, s:s?, s:s?}", "from", from, "at_s", at_s, "slot",
                         slot, "version", version, "code", code, "message", message);
    }
    json_decref(json);
    return last ? last : json_null();
}

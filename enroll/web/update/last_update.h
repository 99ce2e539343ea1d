/* What became of the last update: the file result.json, which install-update of the image writes:
 * {"from": "page", "at_s": 1764170000, "result": ...}, where the result is what
 * `isotherm update --json FILE` says. */
#ifndef WEB_UPDATE_LAST_UPDATE_H
#define WEB_UPDATE_LAST_UPDATE_H

#include <jansson.h>

/* Reads DIR/result.json: {"from", "at_s", "slot", "version", "code", "message"}; code and message
 * are null if the update was installed, and slot and version otherwise. JSON null if there is no
 * such file, or if it has anything else. The caller releases it. */
json_t *web_last_update(const char *folder);

#endif

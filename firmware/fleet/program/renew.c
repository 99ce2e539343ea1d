#include "firmware/fleet/program/renew.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "firmware/fleet/program/hub_call.h"
#include "firmware/fleet/program/tls_key.h"

enum { LEFT_PART = 3 };

bool link_renew_is_due(int64_t stored_s, int64_t ends_s, int64_t now_s)
{
    const int64_t life_s = ends_s > stored_s ? ends_s - stored_s : 0;

    return now_s >= ends_s - life_s / LEFT_PART;
}

int link_renew_look(const char *folder, int64_t now_s, bool *is_due, int64_t *ends_s,
                    struct iso_fault *fault)
{
    char path[PATH_MAX], *text = NULL;
    uint8_t digest[32];
    struct stat file;
    int64_t ends = 0;
    int r = link_home_path(path, folder, LINK_HOME_CERTIFICATE, fault);

    r = r < 0 ? r : link_home_read_text(folder, LINK_HOME_CERTIFICATE, &text, fault);
    r = r < 0 ? r : link_tls_examine(text, digest, &ends, fault);
    free(text);
    if (r == 0 && stat(path, &file)) {
        r = iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    if (r < 0) {
        return r;
    }
    *is_due = link_renew_is_due(file.st_mtime, ends, now_s);
    *ends_s = ends;
    return 0;
}

/* The reply's certificate must be for the door's own key. */
static int store(const char *folder, const struct link_home *home, const char *key,
                 const json_t *reply, struct iso_fault *fault)
{
    const char *certificate = json_string_value(json_object_get(reply, "certificate"));

    if (!certificate || !link_tls_fits(certificate, key)) {
        return iso_fault_set(fault, -EBADMSG, "%s: the certificate is not for this door",
                             home->hub_url);
    }
    return link_home_write_text(folder, LINK_HOME_CERTIFICATE, certificate, fault);
}

int link_renew(const char *folder, const struct link_home *home, struct iso_fault *fault)
{
    char ca_file[PATH_MAX], door[ISO_FLEET_ID_TEXT_SIZE], *key = NULL, *csr = NULL;
    json_t *reply = NULL, *body = NULL;
    int r = link_home_path(ca_file, folder, LINK_HOME_CA, fault);

    r = r < 0 ? r : link_home_read_text(folder, LINK_HOME_KEY, &key, fault);
    r = r < 0 ? r : link_tls_request(key, iso_fleet_id_text(&home->door, door), &csr, fault);
    if (r == 0) {
        body = json_pack("{s:s, s:s}", "door", door, "csr", csr);
        r = body ? link_hub_post(home->hub_url, "/fleet/v1/renew", ca_file, body, &reply, fault)
                 : iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    r = r < 0 ? r : store(folder, home, key, reply, fault);
    json_decref(reply);
    json_decref(body);
    free(csr);
    if (key) {
        sodium_memzero(key, strlen(key));
    }
    free(key);
    return r;
}

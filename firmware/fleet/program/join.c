#include "firmware/fleet/program/join.h"

#include <errno.h>
#include <jansson.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "firmware/fleet/program/hub_call.h"
#include "firmware/fleet/program/tls_key.h"

enum { MEMBERSHIP_MOST_BYTES = 4096 };

/* What the hub answers. */
struct welcome {
    struct link_home home;
    const char *certificate; /* of the JSON object */
    uint8_t membership[MEMBERSHIP_MOST_BYTES];
    size_t membership_size;
};

static bool read_membership(const char *text, struct welcome *out)
{
    return text &&
           sodium_base642bin(out->membership, sizeof out->membership, text, strlen(text), NULL,
                             &out->membership_size, NULL, sodium_base64_VARIANT_ORIGINAL) == 0;
}

static bool read_broker(const json_t *broker, struct link_home *out)
{
    const char *host = json_string_value(json_object_get(broker, "host"));
    const json_int_t port = json_integer_value(json_object_get(broker, "port"));

    if (!host || !host[0] || strlen(host) >= sizeof out->broker_host || port < 1 || port > 65535) {
        return false;
    }
    memcpy(out->broker_host, host, strlen(host) + 1);
    out->broker_port = (uint16_t)port;
    return true;
}

static int read_welcome(const json_t *reply, const char *key, struct welcome *out,
                        struct iso_fault *fault)
{
    const char *door = json_string_value(json_object_get(reply, "door"));
    const char *membership = json_string_value(json_object_get(reply, "membership"));

    out->certificate = json_string_value(json_object_get(reply, "certificate"));
    if (!door || iso_fleet_id_read(door, &out->home.door) < 0 ||
        !read_membership(membership, out) ||
        !read_broker(json_object_get(reply, "broker"), &out->home)) {
        return iso_fault_set(fault, -EBADMSG, "%s: the reply lacks something", out->home.hub_url);
    }
    if (!out->certificate || !link_tls_fits(out->certificate, key)) {
        return iso_fault_set(fault, -EBADMSG, "%s: the certificate is not for this door",
                             out->home.hub_url);
    }
    return 0;
}

static int ask_hub(const struct link_join_address *address, const char *door_address,
                   const char *key, const char *ca_file, json_t **reply, struct iso_fault *fault)
{
    char name[256] = "isotherm", *csr = NULL;

    (void)gethostname(name, sizeof name - 1);
    int r = link_tls_request(key, name, &csr, fault);
    if (r < 0) {
        return r;
    }
    json_t *body = json_pack("{s:s, s:s, s:s, s:s}", "code", address->code, "address", door_address,
                             "csr", csr, "name", name);
    r = body ? link_hub_post(address->url, "/fleet/v1/join", ca_file, body, reply, fault)
             : iso_fault_set(fault, -ENOMEM, "out of memory");
    json_decref(body);
    free(csr);
    return r;
}

/* Everything but link.json is stored before the daemon joins, so that it is there when the daemon
 * belongs to the fleet. */
static int accept_welcome(struct link_bus *bus, const char *folder, const struct welcome *welcome,
                          const char *key, struct iso_fault *fault)
{
    int r = link_home_write_text(folder, LINK_HOME_KEY, key, fault);

    r = r < 0 ? r
              : link_home_write_text(folder, LINK_HOME_CERTIFICATE, welcome->certificate, fault);
    r = r < 0 ? r : link_bus_join(bus, welcome->membership, welcome->membership_size, fault);
    return r < 0 ? r : link_home_write(folder, &welcome->home, fault);
}

static int join_with_key(struct link_bus *bus, const char *folder,
                         const struct link_join_address *address, const char *key,
                         struct link_home *out, struct iso_fault *fault)
{
    struct welcome welcome = {.certificate = NULL};
    char door_address[LINK_ADDRESS_SIZE], ca_file[PATH_MAX], *ca = NULL;
    json_t *reply = NULL;
    int r = link_bus_address(bus, door_address, fault);

    memcpy(welcome.home.hub_url, address->url, sizeof welcome.home.hub_url);
    r = r < 0 ? r : link_home_path(ca_file, folder, LINK_HOME_CA, fault);
    r = r < 0 ? r : link_hub_authority(address->url, address->ca, &ca, fault);
    r = r < 0 ? r : link_home_write_text(folder, LINK_HOME_CA, ca, fault);
    /* From here on the server has to prove that it has a certificate of this authority. */
    r = r < 0 ? r : ask_hub(address, door_address, key, ca_file, &reply, fault);
    r = r < 0 ? r : read_welcome(reply, key, &welcome, fault);
    r = r < 0 ? r : accept_welcome(bus, folder, &welcome, key, fault);
    json_decref(reply);
    free(ca);
    if (r == 0) {
        *out = welcome.home;
    }
    return r;
}

int link_join(struct link_bus *bus, const char *folder, const char *address, struct link_home *out,
              struct iso_fault *fault)
{
    struct link_join_address read;
    struct link_home home;
    char *key = NULL;
    int r = link_join_address_read(address, &read, fault);

    if (r < 0) {
        return r;
    }
    if (link_home_read(folder, &home, NULL) == 0) {
        sodium_memzero(&read, sizeof read);
        return iso_fault_set(fault, -EALREADY,
                             "%s: the door belongs to the fleet of %s; leave it first", folder,
                             home.hub_url);
    }
    r = link_tls_key_make(&key, fault);
    r = r < 0 ? r : join_with_key(bus, folder, &read, key, out, fault);
    if (r < 0) {
        link_home_remove(folder);
    }
    if (key) {
        sodium_memzero(key, strlen(key));
    }
    free(key);
    sodium_memzero(&read, sizeof read);
    return r;
}

int link_leave(struct link_bus *bus, const char *folder, struct iso_fault *fault)
{
    struct iso_link_status status;
    int r = link_bus_status(bus, &status, NULL, fault);

    if (r == 0) {
        r = link_bus_leave(bus, fault);
    }
    /* A daemon that belongs to no fleet has nothing to forget. */
    if (r < 0 && r != -ENOENT) {
        return r;
    }
    link_home_remove(folder);
    return 0;
}

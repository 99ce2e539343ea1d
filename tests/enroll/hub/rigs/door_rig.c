#include "tests/enroll/hub/rigs/door_rig.h"

#include <curl/curl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/scratch.h"

void door_rig_make(struct door_rig *door, const char *folder)
{
    char line[512];

    memset(door, 0, sizeof *door);
    door->folder = folder;
    assert_int_equal(crypto_sign_keypair(door->signs.public, door->signs.secret), 0);
    assert_int_equal(crypto_box_keypair(door->receives.public, door->receives.secret), 0);
    (void)snprintf(line, sizeof line,
                   "cd %s && openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes "
                   "-keyout door.key -subj /CN=door -out door.csr 2>/dev/null",
                   folder);
    assert_int_equal(system(line), 0);
}

size_t door_reply_add(char *bytes, size_t size, size_t n, void *context)
{
    struct door_reply *reply = context;

    reply->bytes = realloc(reply->bytes, reply->size + size * n + 1);
    assert_non_null(reply->bytes);
    memcpy(reply->bytes + reply->size, bytes, size * n);
    reply->size += size * n;
    reply->bytes[reply->size] = '\0';
    return size * n;
}

void door_rig_post(const struct door_rig *door, uint16_t port, const char *path, const char *type,
                   const void *bytes, size_t size, struct door_reply *reply)
{
    char url[128], header[128];
    CURL *curl = curl_easy_init();

    assert_non_null(curl);
    *reply = (struct door_reply){.bytes = calloc(1, 1)};
    (void)snprintf(url, sizeof url, "https://127.0.0.1:%u%s", port, path);
    (void)snprintf(header, sizeof header, "Content-Type: %s", type);
    struct curl_slist *headers = curl_slist_append(NULL, header);
    (void)curl_easy_setopt(curl, CURLOPT_URL, url);
    (void)curl_easy_setopt(curl, CURLOPT_CAINFO, scratch_path(door->folder, "ca.pem"));
    (void)curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers);
    (void)curl_easy_setopt(curl, CURLOPT_POSTFIELDS, size ? bytes : "");
    (void)curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE, (long)size);
    (void)curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, door_reply_add);
    (void)curl_easy_setopt(curl, CURLOPT_WRITEDATA, reply);
    (void)curl_easy_setopt(curl, CURLOPT_TIMEOUT, 60L);
    (void)curl_easy_setopt(curl, CURLOPT_NOPROXY, "*");
    const CURLcode code = curl_easy_perform(curl);
    if (code == CURLE_OK) {
        (void)curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &reply->status);
    } else {
        print_message("%s: %s\n", url, curl_easy_strerror(code));
    }
    curl_slist_free_all(headers);
    curl_easy_cleanup(curl);
}

static void take_membership(struct door_rig *door, const char *base64)
{
    uint8_t bytes[2048];
    size_t size = 0;

    assert_int_equal(sodium_base642bin(bytes, sizeof bytes, base64, strlen(base64), NULL, &size,
                                       NULL, sodium_base64_VARIANT_ORIGINAL),
                     0);
    assert_int_equal(iso_fleet_read_membership(bytes, size, &door->membership), 0);
    assert_memory_equal(door->membership.door_signs, door->signs.public, ISO_FLEET_PUBLIC_BYTES);
    (void)iso_fleet_id_text(&door->membership.door, door->id);
}

static void take_reply(struct door_rig *door, const char *text)
{
    json_error_t error;
    json_t *json = json_loads(text, 0, &error);
    const char *id, *membership, *certificate, *ca, *host;

    if (json_unpack_ex(json, &error, 0, "{s:s, s:s, s:s, s:s, s:{s:s, s:i}}", "door", &id,
                       "membership", &membership, "certificate", &certificate, "ca", &ca, "broker",
                       "host", &host, "port", &door->broker_port)) {
        fail_msg("%s: %s", error.text, text);
    }
    take_membership(door, membership);
    assert_string_equal(id, door->id);
    char *known = scratch_read_text(scratch_path(door->folder, "ca.pem"));
    assert_string_equal(ca, known);
    free(known);
    (void)snprintf(door->broker_host, sizeof door->broker_host, "%s", host);
    scratch_write_text(scratch_path(door->folder, "door.pem"), certificate);
    json_decref(json);
}

long door_rig_join(struct door_rig *door, uint16_t port, const char *code)
{
    char address[129];
    struct door_reply reply;
    char *csr = scratch_read_text(scratch_path(door->folder, "door.csr"));

    (void)sodium_bin2hex(address, sizeof address, door->signs.public, 32);
    (void)sodium_bin2hex(address + 64, sizeof address - 64, door->receives.public, 32);
    json_t *json = json_pack("{s:s, s:s, s:s, s:s}", "code", code, "address", address, "csr", csr,
                             "name", "own name");
    char *body = json_dumps(json, 0);
    door_rig_post(door, port, "/fleet/v1/join", "application/json", body, strlen(body), &reply);
    if (reply.status == 200) {
        take_reply(door, reply.bytes);
    } else {
        print_message("join: %ld %s\n", reply.status, reply.bytes);
    }
    free(reply.bytes);
    free(body);
    json_decref(json);
    free(csr);
    return reply.status;
}

bool door_rig_connect(struct door_rig *door, const struct iso_fleet_id *zone)
{
    char topic[ISO_FLEET_TOPIC_SIZE];

    broker_client_begin(
        &door->client, door->id, (uint16_t)door->broker_port, scratch_path(door->folder, "ca.pem"),
        scratch_path(door->folder, "door.pem"), scratch_path(door->folder, "door.key"));
    if (!broker_client_connects(&door->client)) {
        return false;
    }
    broker_client_subscribe(&door->client, iso_fleet_topic_in(&door->membership.door, topic));
    broker_client_subscribe(&door->client, iso_fleet_topic_delta(zone, topic));
    broker_client_subscribe(&door->client, iso_fleet_topic_head(zone, topic));
    broker_client_publish(&door->client, iso_fleet_topic_online(&door->membership.door, topic), "1",
                          1, true);
    return true;
}

/* Takes a message of the door's mail: true if it is the lease that answers the nonce. */
static bool take_mail(struct door_rig *door, const struct broker_message *message,
                      const uint8_t nonce[ISO_FLEET_NONCE_BYTES], struct iso_fleet_lease *lease)
{
    const uint8_t *hub = door->membership.hub_signs;
    struct iso_fleet_key_grant grant;
    enum iso_fleet_kind kind;

    assert_int_equal(iso_fleet_kind_of(message->bytes, message->size, &kind), 0);
    if (kind == ISO_FLEET_KEY) {
        assert_int_equal(
            iso_fleet_read_key(message->bytes, message->size, hub, &door->receives, &grant), 0);
        assert_true(iso_fleet_id_is_same(&grant.door, &door->membership.door));
        door->key = grant.key;
        if (door->place.epoch == 0) {
            door->place = grant.base;
        }
        door->place.epoch = grant.base.epoch;
        return false;
    }
    if (kind != ISO_FLEET_LEASE) {
        return false;
    }
    assert_int_equal(iso_fleet_read_lease(message->bytes, message->size, hub, lease), 0);
    return memcmp(lease->nonce, nonce, sizeof lease->nonce) == 0;
}

/* Whether a KEY comes behind the lease. */
static bool lacks_key(const struct door_rig *door, const struct iso_fleet_lease *lease)
{
    return lease->n > 0 && lease->places[0].epoch != door->place.epoch;
}

bool door_rig_ask(struct door_rig *door, const char *health, uint64_t last_event,
                  struct iso_fleet_lease *lease, double seconds)
{
    struct iso_fleet_question question = {.door = door->membership.door,
                                          .time_s = time(NULL),
                                          .algorithm = 1,
                                          .last_event = last_event,
                                          .n = door->place.epoch ? 1 : 0,
                                          .health = health,
                                          .health_length = strlen(health)};
    struct iso_fleet_bytes bytes = {.size = 0};
    char in[ISO_FLEET_TOPIC_SIZE], out[ISO_FLEET_TOPIC_SIZE];
    const size_t from = door->client.n;

    question.places[0] = door->place;
    randombytes_buf(question.nonce, sizeof question.nonce);
    assert_int_equal(iso_fleet_make_question(&question, &door->signs, &bytes), 0);
    (void)iso_fleet_topic_in(&door->membership.door, in);
    broker_client_publish(&door->client, iso_fleet_topic_out(&door->membership.door, out),
                          bytes.bytes, bytes.size, false);
    iso_fleet_bytes_free(&bytes);
    bool answered = false;
    for (int at = (int)from; !answered || lacks_key(door, lease); at++) {
        at = broker_client_wait(&door->client, in, (size_t)at, seconds);
        if (at < 0) {
            return false;
        }
        answered |= take_mail(door, &door->client.messages[at], question.nonce, lease);
    }
    return true;
}

unsigned door_rig_follow(struct door_rig *door, size_t from)
{
    const struct broker_client *client = &door->client;
    struct iso_fleet_delta delta;
    enum iso_fleet_kind kind;
    unsigned known = 0;

    for (size_t i = from; i < client->n; i++) {
        const struct broker_message *m = &client->messages[i];
        if (iso_fleet_kind_of(m->bytes, m->size, &kind) || kind != ISO_FLEET_DELTA) {
            continue;
        }
        assert_int_equal(
            iso_fleet_read_delta(m->bytes, m->size, door->membership.hub_signs, &delta), 0);
        switch (iso_fleet_step_of(&door->place, &delta)) {
        case ISO_FLEET_STEP_NEXT:
            door->place = delta.place;
            break;
        case ISO_FLEET_STEP_KNOWN:
            known++;
            break;
        default:
            fail_msg("delta %llu does not follow %llu", (unsigned long long)delta.place.sequence,
                     (unsigned long long)door->place.sequence);
        }
    }
    return known;
}

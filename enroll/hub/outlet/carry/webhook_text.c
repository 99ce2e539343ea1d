#include "enroll/hub/outlet/carry/webhook_text.h"

#include <inttypes.h>
#include <jansson.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

static json_t *event_json(const struct hub__batch_event *event)
{
    char door[ISO_FLEET_ID_TEXT_SIZE];
    return json_pack("{s:s,s:s,s:I,s:s,s:s,s:o}", "door", iso_fleet_id_text(&event->door, door),
                     "door_name", event->door_name, "number", (json_int_t)event->number, "time",
                     event->time, "event", event->event, "record",
                     json_loads(event->record, JSON_REJECT_DUPLICATES, NULL));
}

char *hub__webhook_body(const struct hub__batch *batch)
{
    json_t *array = json_array();
    char *body = NULL;
    bool whole = array;
    for (size_t i = 0; whole && i < batch->n; i++) {
        const struct hub__batch_event event = hub__batch_event(batch, i);
        whole = json_array_append_new(array, event_json(&event)) == 0;
    }
    if (whole) {
        body = json_dumps(array, JSON_COMPACT);
    }
    json_decref(array);
    return body;
}

void hub__webhook_sign(const char *secret, int64_t time_s, const char *body,
                       char out[HUB__SIGNATURE_SIZE])
{
    crypto_auth_hmacsha256_state state;
    uint8_t mac[crypto_auth_hmacsha256_BYTES];
    char digits[2 * sizeof mac + 1], time[24];
    (void)snprintf(time, sizeof time, "%" PRId64, time_s);
    (void)crypto_auth_hmacsha256_init(&state, (const uint8_t *)secret, strlen(secret));
    (void)crypto_auth_hmacsha256_update(&state, (const uint8_t *)time, strlen(time));
    (void)crypto_auth_hmacsha256_update(&state, (const uint8_t *)".", 1);
    (void)crypto_auth_hmacsha256_update(&state, (const uint8_t *)body, strlen(body));
    (void)crypto_auth_hmacsha256_final(&state, mac);
    sodium_memzero(&state, sizeof state);
    (void)snprintf(out, HUB__SIGNATURE_SIZE, "t=%s,v1=%s", time,
                   sodium_bin2hex(digits, sizeof digits, mac, sizeof mac));
}

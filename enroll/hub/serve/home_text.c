#include "enroll/hub/serve/home_text.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *word, *title, *kind; /* kind: the class of Home Assistant */
} parts[HOME_PARTS] = {
    [HOME_LOCK] = {"lock", "Lock", "lock"},
    [HOME_CONTACT] = {"contact", "Contact", "door"},
    [HOME_TAMPER] = {"tamper", "Tamper", "tamper"},
    [HOME_LOCKDOWN] = {"lockdown", "Lockdown", "safety"},
};

const char *home_topic_config(const struct hub_door *door, enum home_part part,
                              char topic[HOME_TOPIC_SIZE])
{
    char id[ISO_FLEET_ID_TEXT_SIZE];

    (void)snprintf(topic, HOME_TOPIC_SIZE, "homeassistant/binary_sensor/isotherm-%s/%s/config",
                   iso_fleet_id_text(&door->id, id), parts[part].word);
    return topic;
}

const char *home_topic_state(const struct hub_door *door, char topic[HOME_TOPIC_SIZE])
{
    char id[ISO_FLEET_ID_TEXT_SIZE];

    (void)snprintf(topic, HOME_TOPIC_SIZE, "isotherm/door/%s/state",
                   iso_fleet_id_text(&door->id, id));
    return topic;
}

static char *text_of(json_t *json)
{
    char *text = json ? json_dumps(json, JSON_COMPACT) : NULL;

    json_decref(json);
    return text;
}

char *home_config(const struct hub_door *door, enum home_part part, const char *hub_name)
{
    char id[ISO_FLEET_ID_TEXT_SIZE], unique[96], object[96], template[64], topic[HOME_TOPIC_SIZE],
        online[ISO_FLEET_TOPIC_SIZE];

    (void)iso_fleet_id_text(&door->id, id);
    (void)snprintf(unique, sizeof unique, "isotherm-%s-%s", id, parts[part].word);
    (void)snprintf(object, sizeof object, "isotherm-%s", id);
    (void)snprintf(template, sizeof template, "{{ value_json.%s }}", parts[part].word);
    return text_of(json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:{s:[s], s:s, s:s, s:s}}",
                             "name", parts[part].title, "unique_id", unique, "device_class",
                             parts[part].kind, "state_topic", home_topic_state(door, topic),
                             "value_template", template, "availability_topic",
                             iso_fleet_topic_online(&door->id, online), "payload_available", "1",
                             "payload_not_available", "0", "device", "identifiers", object, "name",
                             door->name, "manufacturer", "Isotherm", "suggested_area", hub_name));
}

/* "ON", "OFF" or null. */
static json_t *switch_of(bool is_known, bool on)
{
    return is_known ? json_string(on ? "ON" : "OFF") : json_null();
}

static bool is_one_of(const char *word, const char *const *words)
{
    while (*words && strcmp(*words, word) != 0) {
        words++;
    }
    return *words != NULL;
}

char *home_state(const struct hub_door *door, bool is_lockdown)
{
    static const char *const known[] = {"locked",    "unlocked", "opened",
                                        "held-open", "forced",   NULL};
    static const char *const open[] = {"opened", "held-open", "forced", NULL};
    json_t *health = json_loads(door->health, JSON_REJECT_DUPLICATES, NULL);
    const char *state = json_string_value(json_object_get(health, "door-state"));
    const json_t *tamper = json_object_get(health, "tamper");
    const bool is_known = state && is_one_of(state, known);
    const bool is_forced = is_known && strcmp(state, "forced") == 0;
    json_t *json = json_pack("{s:o, s:o, s:o, s:o}", "lock",
                             switch_of(is_known, is_known && strcmp(state, "locked") != 0),
                             "contact", switch_of(is_known, is_known && is_one_of(state, open)),
                             "tamper",
                             switch_of(is_known || json_is_integer(tamper),
                                       is_forced || json_integer_value(tamper) != 0),
                             "lockdown", switch_of(true, is_lockdown));

    json_decref(health);
    return text_of(json);
}

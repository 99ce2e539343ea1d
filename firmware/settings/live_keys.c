#include "firmware/settings/live_keys.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/config/config_value.h"

/* [door] relay_pulse_ms fits the lock, [lockout] path names a file. */
static const struct {
    const char *section, *names; /* "|name|name|" */
} sections[] = {
    {"door", "|unlock_ms|held_ms|refused_ms|"},
    {"decision", "|level|threshold|margin|agree|max_frames|attack_frames|gap_ms|refractory_ms|"},
    {"update", "|templates|score|"},
    {"lockout", "|failures|attacks|first_ms|longest_ms|forget_ms|"},
    {"motion", "|still_mm_s|still_deg_s|jump_mm_s|jump_deg_s|lifeless_ms|frozen_frames|"},
    {"hint", "|hold_frames|interval_ms|"},
    {"enroll",
     "|stages|agree_score|duplicate_score|yaw_max_deg|pitch_max_deg|coverage_min|"
     "landmark_coverage_min|expression_max|mouth_max_mm|timeout_ms|pose_stages|pose_timeout_ms|"
     "pose_yaw_deg|pose_pitch_deg|pose_within_deg|pose_coverage_min|"},
    {"bus", "|action_ms|claim_ms|"},
};

/* Whether a list "|a|b|" has a word. */
static bool has_word(const char *list, const char *word)
{
    const size_t n = strlen(word);
    for (const char *at = list + 1; *at; at = strchr(at, '|') + 1) {
        if (strncmp(at, word, n) == 0 && at[n] == '|') {
            return true;
        }
    }
    return false;
}

static bool is_live(const struct iso_config_key *key)
{
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++) {
        if (strcmp(sections[i].section, key->section) == 0) {
            return has_word(sections[i].names, key->name);
        }
    }
    return false;
}

size_t iso_live_keys_count(void)
{
    size_t n = 0;
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        n += is_live(&iso_config_keys[i]);
    }
    return n;
}

const struct iso_config_key *iso_live_key_at(size_t index)
{
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        if (is_live(&iso_config_keys[i]) && index-- == 0) {
            return &iso_config_keys[i];
        }
    }
    return NULL;
}

static const struct iso_config_key *find(const char *section, const char *name)
{
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        if (strcmp(iso_config_keys[i].section, section) == 0 &&
            strcmp(iso_config_keys[i].name, name) == 0) {
            return &iso_config_keys[i];
        }
    }
    return NULL;
}

const struct iso_config_key *iso_live_key_find(const char *section, const char *name)
{
    const struct iso_config_key *key = find(section, name);
    return key && is_live(key) ? key : NULL;
}

int iso_live_key_need(const char *section, const char *name, const struct iso_config_key **out,
                      struct iso_fault *fault)
{
    const struct iso_config_key *key = find(section, name);
    if (!key && strcmp(section, "sensor") != 0 && strcmp(section, "door") != 0) {
        return iso_fault_set(fault, -EINVAL, "unknown key '%.64s' in [%.64s]", name, section);
    }
    /* Other keys of [sensor] and [door] are options of a back end. */
    if (!key || !is_live(key)) {
        return iso_fault_set(fault, -EINVAL,
                             "[%.64s] %.64s cannot be changed while the daemon runs: change it in "
                             "the configuration file and restart the daemon",
                             section, name);
    }
    *out = key;
    return 0;
}

int iso_live_key_set(struct iso_config *config, const struct iso_config_key *key, const char *value,
                     struct iso_fault *fault)
{
    struct iso_config changed = *config;
    char expected[96];
    if (iso__config_store(key, value, &changed)) {
        iso__config_describe(key, expected, sizeof expected);
        return iso_fault_set(fault, -EINVAL, "bad value '%.64s' for '%s' (%s)", value, key->name,
                             expected);
    }
    const char *conflict = iso__config_find_conflict(&changed);
    if (conflict) {
        return iso_fault_set(fault, -EINVAL, "%s", conflict);
    }
    *config = changed;
    return 0;
}

void iso_live_key_print(const struct iso_config *config, const struct iso_config_key *key,
                        char value[ISO_LIVE_VALUE_SIZE])
{
    iso__config_print(key, config, value, ISO_LIVE_VALUE_SIZE);
}
